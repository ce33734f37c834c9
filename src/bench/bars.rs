//! Bar charts as SVG.

use std::fmt::Write;

/// One a series.
pub(super) const COLOURS: [&str; 5] = ["#3b6ea5", "#d08c36", "#5a9a5a", "#a5504f", "#7d6aa8"];

/// A chart of horizontal bars: for each row a label and a value per series.
pub fn draw_bars(title: &str, unit: &str, series: &[&str], rows: &[(String, Vec<f64>)]) -> String {
    const LABEL: f64 = 250.0;
    const WIDTH: f64 = 420.0;
    const BAR: f64 = 9.0;
    let all = rows.iter().flat_map(|(_, values)| values.iter().copied());
    let largest = all.filter(|value| value.is_finite()).fold(1e-9, f64::max);
    let group = BAR * series.len() as f64 + 6.0;
    let top = 44.0;
    let height = top + group * rows.len() as f64 + 8.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"10\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n<text x=\"8\" y=\"16\" font-size=\"13\">{} ({unit})</text>\n",
        LABEL + WIDTH + 70.0,
        escape(title),
    );
    for (i, name) in series.iter().enumerate() {
        let x = LABEL + 90.0 * i as f64;
        let colour = COLOURS[i % COLOURS.len()];
        // Writing to a string can't fail.
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"26\" width=\"9\" height=\"9\" fill=\"{colour}\"/>\
             <text x=\"{}\" y=\"34\">{}</text>",
            x + 13.0,
            escape(name)
        );
    }
    for (i, (label, values)) in rows.iter().enumerate() {
        let y = top + group * i as f64;
        let middle = y + BAR * series.len() as f64 / 2.0 + 3.0;
        let label = escape(label);
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{middle}\" text-anchor=\"end\">{label}</text>",
            LABEL - 6.0
        );
        for (j, &value) in values.iter().enumerate() {
            let (y, colour) = (y + BAR * j as f64, COLOURS[j % COLOURS.len()]);
            let width = if value.is_finite() { value.max(0.0) / largest * WIDTH } else { 0.0 };
            let _ = writeln!(
                svg,
                "<rect x=\"{LABEL}\" y=\"{y}\" width=\"{width:.1}\" height=\"{}\" \
                 fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{}\" font-size=\"8\">{value:.3}</text>",
                BAR - 1.0,
                LABEL + width + 4.0,
                y + BAR - 2.0
            );
        }
    }
    svg + "</svg>\n"
}

/// For the text of an element.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_fills_the_width_and_labels_are_escaped() {
        let rows = [("a<b".to_owned(), vec![1.0]), ("c".to_owned(), vec![2.0])];
        let svg = draw_bars("rates", "Mrays/s", &["random"], &rows);
        assert!(svg.contains("width=\"210.0\"") && svg.contains("width=\"420.0\""));
        assert!(svg.contains("a&lt;b") && svg.ends_with("</svg>\n"));
    }
}

//! Plots of curves as SVG.

use std::fmt::Write;

use super::bars::{COLOURS, escape};

/// A curve: its name, and points from left to right.
#[derive(Clone, Debug)]
pub struct Curve {
    /// For the legend.
    pub name: String,
    /// Abscissa and value.
    pub points: Vec<(f64, f64)>,
}

const LEFT: f64 = 60.0;
const TOP: f64 = 48.0;
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 260.0;
/// What is not above zero has no place on a logarithmic axis: it stands this far left of it.
const ZERO: f64 = 30.0;

/// The horizontal axis: decades from the smallest positive abscissa to the largest.
struct Axis {
    low: f64,
    high: f64,
    zero: bool,
}

impl Axis {
    fn of(curves: &[Curve]) -> Self {
        let all = || curves.iter().flat_map(|curve| &curve.points).map(|point| point.0);
        let positive = || all().filter(|x| *x > 0.0).map(libm::log10);
        let (low, high) =
            (positive().fold(f64::MAX, f64::min), positive().fold(f64::MIN, f64::max));
        let zero = all().any(|x| x <= 0.0);
        let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
        Self { low, high, zero }
    }

    fn place(&self, x: f64) -> f64 {
        let begin = if self.zero { ZERO } else { 0.0 };
        if x <= 0.0 {
            return LEFT;
        }
        let share = (libm::log10(x) - self.low) / (self.high - self.low);
        LEFT + begin + share * (WIDTH - begin)
    }
}

/// Curves over a logarithmic horizontal axis; the vertical one begins at zero.
pub fn draw_curves(title: &str, across: &str, unit: &str, curves: &[Curve]) -> String {
    let axis = Axis::of(curves);
    let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let step = round_up(values.filter(|value| value.is_finite()).fold(1e-9, f64::max) / 5.0);
    let largest = step * 5.0;
    let up = |value: f64| TOP + HEIGHT * (1.0 - value / largest);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
         font-family=\"sans-serif\" font-size=\"10\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n<text x=\"8\" y=\"16\" font-size=\"13\">{} ({})</text>\n",
        LEFT + WIDTH + 30.0,
        TOP + HEIGHT + 44.0,
        escape(title),
        escape(unit),
    );
    // Writing to a string can't fail.
    for i in 0..=5 {
        let (value, y) = (step * f64::from(i), up(step * f64::from(i)));
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {y:.1}h{WIDTH}\" stroke=\"#ddd\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 6.0,
            y + 3.0,
            format_short(value)
        );
    }
    let bottom = TOP + HEIGHT;
    for x in ticks(&axis) {
        let place = axis.place(x);
        let _ = writeln!(
            svg,
            "<path d=\"M{place:.1} {bottom}v4\" stroke=\"black\"/>\
             <text x=\"{place:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 16.0,
            format_short(x)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        LEFT + WIDTH / 2.0,
        bottom + 34.0,
        escape(across)
    );
    for (i, curve) in curves.iter().enumerate() {
        svg += &draw_curve(i, curve, |(x, y)| (axis.place(x), up(y.max(0.0))));
    }
    svg + "</svg>\n"
}

/// A curve with its points and its name in the legend; `place` tells where points lie.
fn draw_curve(i: usize, curve: &Curve, place: impl Fn((f64, f64)) -> (f64, f64)) -> String {
    let mut svg = String::new();
    let (colour, x) = (COLOURS[i % COLOURS.len()], LEFT + 110.0 * i as f64);
    let finite = curve.points.iter().filter(|point| point.1.is_finite());
    let places: Vec<_> = finite.map(|&point| place(point)).collect();
    let path: Vec<_> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = writeln!(
        svg,
        "<rect x=\"{x}\" y=\"27\" width=\"9\" height=\"9\" fill=\"{colour}\"/>\
         <text x=\"{}\" y=\"35\">{}</text>\n<polyline points=\"{}\" fill=\"none\" \
         stroke=\"{colour}\" stroke-width=\"1.5\"/>",
        x + 13.0,
        escape(&curve.name),
        path.join(" ")
    );
    for (x, y) in places {
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"{colour}\"/>");
    }
    svg
}

/// Powers of ten on the axis, and zero if it is there.
fn ticks(axis: &Axis) -> Vec<f64> {
    let (low, high) = ((axis.low - 1e-6).ceil() as i32, (axis.high + 1e-6).floor() as i32);
    let powers = (low..=high).map(|power| libm::pow(10.0, f64::from(power)));
    axis.zero.then_some(0.0).into_iter().chain(powers).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
fn round_up(least: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(least).floor());
    let of = [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power);
    of.into_iter().find(|&step| step >= least).unwrap_or(10.0 * power)
}

fn format_short(value: f64) -> String {
    let rounded = format!("{value:.4}");
    rounded.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_fill_the_frame_and_zero_stands_left_of_the_decades() {
        let points = vec![(0.0, 1.0), (0.01, 5.0), (1.0, 0.0)];
        let svg = draw_curves("r<t", "I", "Mrays/s", &[Curve { name: "bvh2".to_owned(), points }]);
        let (y1, y5, y0) = (TOP + HEIGHT * 0.8, TOP, TOP + HEIGHT);
        let expected = format!(
            "points=\"{LEFT:.1},{y1:.1} {:.1},{y5:.1} {:.1},{y0:.1}\"",
            LEFT + ZERO,
            LEFT + WIDTH
        );
        assert!(svg.contains(&expected), "{expected} in {svg}");
        assert!(svg.contains("r&lt;t") && svg.contains(">0.01</text>") && svg.contains(">bvh2<"));
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!([0.9, 1.0, 1.1, 30.0, 51.0].map(round_up), [1.0, 1.0, 2.0, 50.0, 100.0]);
    }

    #[test]
    fn nothing_to_plot_is_an_empty_frame() {
        assert!(draw_curves("", "", "", &[]).ends_with("</svg>\n"));
    }
}

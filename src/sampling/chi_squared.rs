//! Pearson's chi-squared test of fit, for the tests of everything that samples.

/// The chance of a false alarm in a whole family of tests.
const SIGNIFICANCE: f64 = 0.01;

/// Cells that expect fewer counts are pooled: the statistic is only then nearly chi-squared.
const LEAST_EXPECTED: f64 = 5.0;

/// Panics unless `counts` look drawn from `expected` (counts, not probabilities), at a level that
/// is Šidák-corrected for a family of `family` tests.
///
/// A cell that expects nothing (below 1e-9) must hold nothing.
pub(crate) fn assert_fits(counts: &[u64], expected: &[f64], family: usize, what: &str) {
    assert_eq!(counts.len(), expected.len());
    let mut cells: Vec<(f64, u64)> = expected.iter().copied().zip(counts.iter().copied()).collect();
    for (cell, &(expect, count)) in cells.iter().enumerate() {
        assert!(expect >= -1e-3, "{what}: cell {cell} expects {expect}");
        assert!(expect > 1e-9 || count == 0, "{what}: {count} in the impossible cell {cell}");
    }
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));

    let (mut statistic, mut used, mut pooled) = (0.0, 0_usize, (0.0, 0_u64));
    let mut add = |expect: f64, count: u64| {
        let difference = count as f64 - expect;
        statistic += difference * difference / expect;
        used += 1;
    };
    for (expect, count) in cells {
        if expect >= LEAST_EXPECTED {
            add(expect, count);
        } else {
            pooled = (pooled.0 + expect, pooled.1 + count);
            if pooled.0 >= LEAST_EXPECTED {
                add(pooled.0, pooled.1);
                pooled = (0.0, 0);
            }
        }
    }
    // A rest too small to test is left out.
    assert!(used > 1, "{what}: all counts in one cell");
    let p_value = upper_gamma((used - 1) as f64 / 2.0, statistic / 2.0);
    let level = 1.0 - libm::pow(1.0 - SIGNIFICANCE, 1.0 / family as f64);
    assert!(
        p_value > level,
        "{what}: chi-squared {statistic:.1} at {} degrees of freedom, p = {p_value:.2e}",
        used - 1
    );
}

/// The regularised upper incomplete gamma function Q(a, x): by its series below `a + 1`, by its
/// continued fraction above (Press et al., "Numerical Recipes", 6.2).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let scale = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - sum * scale
    } else {
        let mut b = x + 1.0 - a;
        let (mut c, mut d) = (1e300, 1.0 / b);
        let mut fraction = d;
        for i in 1..10_000 {
            let an = -f64::from(i) * (f64::from(i) - a);
            b += 2.0;
            d = 1.0 / (an * d + b);
            c = b + an / c;
            fraction *= d * c;
            if (d * c - 1.0).abs() < 1e-14 {
                break;
            }
        }
        scale * fraction
    }
}

#[test]
fn the_tail_of_chi_squared() {
    // Two degrees of freedom: exp(-x / 2). One: the normal's two tails.
    assert!((upper_gamma(1.0, 3.0) - libm::exp(-3.0)).abs() < 1e-12);
    assert!((upper_gamma(0.5, 0.5 * 1.959_964 * 1.959_964) - 0.05).abs() < 1e-6);
    assert!((upper_gamma(50.0, 50.0) - 0.481_191_7).abs() < 1e-6);
}

#[test]
#[should_panic(expected = "chi-squared")]
fn a_loaded_die_is_found() {
    assert_fits(&[1100, 900, 1000], &[1000.0; 3], 1, "die");
}

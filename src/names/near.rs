//! Names that are like the one that was meant.

/// The numbers of up to three of `names` that someone who wrote `wanted` may have meant, the
/// likeliest first. At most half of the letters of such a name are others, or `wanted` is its
/// beginning.
pub fn near<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<usize> {
    let wanted = wanted.to_lowercase();
    let likeness = |name: &str| strsim::jaro_winkler(&name.to_lowercase(), &wanted);
    let is_near = |name: &str| {
        let name = name.to_lowercase();
        let most = name.chars().count().max(wanted.chars().count()) / 2;
        name.starts_with(&wanted) || strsim::osa_distance(&name, &wanted) <= most
    };
    let mut near: Vec<(f64, usize)> = names
        .into_iter()
        .enumerate()
        .filter(|&(_, name)| is_near(name))
        .map(|(number, name)| (likeness(name), number))
        .filter(|&(likeness, _)| likeness > 0.7)
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(3).map(|(_, number)| number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likeliest_comes_first_whatever_its_case() {
        assert_eq!(near("Frnt", ["back", "font", "front"]), [2, 1]);
        assert_eq!(near("zzz", ["back", "front"]), [0_usize; 0]);
    }

    #[test]
    fn letters_in_common_alone_make_no_guess() {
        assert_eq!(near("nope", ["auto", "kd-ropes"]), [0_usize; 0]);
        assert_eq!(near("bar", ["bvh-partition"]), [0_usize; 0]);
        assert_eq!(near("kdrope", ["auto", "kd-ropes"]), [1]);
        assert_eq!(near("kd-st", ["kd-wide", "kd-stack-origin"]), [1]);
    }
}

//! Misspelt word -> the known word nearest to it, for error messages.
//!
//! A wrong guess is worse than none: it sends people to a setting that they do not mean. So a
//! word must be nearly the same, or begin only one known word.

/// Similarity from 0 to 1 that a known word must have: about one wrong letter in four, or two
/// letters changed over in a word of four.
const ALIKE: f64 = 0.7;

/// Letters of a word that may stand for the one known word which begins with it.
const LEAST_BEGINNING: usize = 4;

/// The known word nearest to `word`, if any is near. A known dotted name is
/// also compared by its last part, because users leave the table out.
#[must_use]
pub fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let score = |name: &str| {
        let last = name.rsplit('.').next().unwrap_or(name);
        let whole = strsim::normalized_damerau_levenshtein(&word, name);
        let part = 0.95 * strsim::normalized_damerau_levenshtein(&word, last);
        whole.max(part)
    };
    let known: Vec<&str> = known.collect();
    let scored = known.iter().map(|name| (score(name), *name));
    let best = scored
        .filter(|(score, _)| *score >= ALIKE)
        // Names break ties, so that the message never depends on the order of the list.
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)));
    best.map(|(_, name)| name).or_else(|| begun(&word, &known))
}

/// The only known word that begins with `word`.
fn begun<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut fits = known.iter().filter(|name| name.starts_with(word));
    let first = fits.next().filter(|_| word.len() >= LEAST_BEGINNING)?;
    fits.next().is_none().then_some(*first)
}

/// `; did you mean …?`, or nothing where no known word is near.
#[must_use]
pub fn did_you_mean<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> String {
    nearest(word, known).map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let known = ["layer_height", "speed.travel", "walls", "zcube-dual"];
        for (word, found) in [
            ("layer_heigth", Some("layer_height")),
            ("travel", Some("speed.travel")),
            ("wals", Some("walls")),
            ("zcube", Some("zcube-dual")),
            ("zcu", None),
            ("zzz", None),
            ("layers", None),
        ] {
            assert_eq!(nearest(word, known.into_iter()), found, "{word}");
        }
        assert_eq!(nearest("skirt", ["strict", "quiet"].into_iter()), None);
        assert_eq!(nearest("same", ["same-a", "same-b"].into_iter()), None);
    }
}

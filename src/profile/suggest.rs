//! Misspelt word -> the known word nearest to it, for error messages.

/// Similarity from 0 to 1 below which a suggestion would confuse more than it helps.
const ALIKE: f64 = 0.5;

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
    known
        .map(|name| (score(name), name))
        .filter(|(score, _)| *score >= ALIKE)
        // Names break ties, so that the message never depends on the order of the list.
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, name)| name)
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
        let known = ["layer_height", "speed.travel", "walls"];
        assert_eq!(nearest("layer_heigth", known.into_iter()), Some("layer_height"));
        assert_eq!(nearest("travel", known.into_iter()), Some("speed.travel"));
        assert_eq!(nearest("zzz", known.into_iter()), None);
    }
}

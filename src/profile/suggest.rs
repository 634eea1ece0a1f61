//! Misspelt word -> the known word nearest to it, for error messages.
//!
//! A wrong guess is worse than none: it sends people to a setting that they do not mean. So a
//! word must be nearly the same, or begin only one known word. Where its table is missing or wrong, all known
//! words with such a last part are named: nobody can tell which is meant.

/// Similarity from 0 to 1 that a known word must have: about one wrong letter in four, or two
/// letters changed over in a word of four.
const ALIKE: f64 = 0.7;

/// Letters of a word that may stand for the one known word which begins with it.
const LEAST_BEGINNING: usize = 4;

/// Letters of a word that may stand for those which hold it.
const LEAST_HELD: usize = 3;

/// Known words that are named at once, at most.
const MOST_NAMED: usize = 6;

/// The known word nearest to `word`, if any is near. A known dotted name is
/// also compared by its last part, because users leave the table out.
#[must_use]
pub fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let score = |name: &str| {
        let whole = strsim::normalized_damerau_levenshtein(&word, name);
        if !word.contains('.') {
            return whole.max(0.95 * strsim::normalized_damerau_levenshtein(&word, last(name)));
        }
        // The same table makes other keys look alike.
        let part = strsim::normalized_damerau_levenshtein(last(&word), last(name));
        if part < ALIKE { 0.0 } else { whole }
    };
    let known: Vec<&str> = known.collect();
    let scored = known.iter().map(|name| (score(name), *name));
    let best = scored
        .filter(|(score, _)| *score >= ALIKE)
        // Names break ties, so that the message never depends on the order of the list.
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)));
    best.map(|(_, name)| name).or_else(|| begun(&word, &known))
}

/// The last part of a dotted name.
fn last(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// The known dotted names with the last part of `word`, after those without a table that are nearly the same, if
/// they are few.
fn same_part<'a>(word: &str, known: &[&'a str]) -> Vec<&'a str> {
    let word = word.to_lowercase();
    let is_same = |name: &&&str| name.contains('.') && last(name) == last(&word);
    let same: Vec<&str> = known.iter().filter(is_same).copied().collect();
    let near = |name: &str| strsim::normalized_damerau_levenshtein(&word, name) >= ALIKE;
    let bare = known.iter().copied().filter(|name| !name.contains('.') && near(name));
    match same.len() {
        1..=MOST_NAMED => bare.chain(same.iter().copied()).collect(),
        _ => Vec::new(),
    }
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
    let known: Vec<&str> = known.collect();
    let mut named = same_part(word, &known);
    if named.is_empty() {
        named.extend(nearest(word, known.iter().copied()));
    }
    asked(&named)
}

/// As [`did_you_mean`], by the known words that hold `word`, if they are few.
#[must_use]
pub fn containing<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> String {
    let word = word.to_lowercase();
    let holding: Vec<&str> = known.filter(|name| name.contains(&word)).collect();
    let is_one = word.len() >= LEAST_HELD && holding.len() <= MOST_NAMED;
    if is_one { asked(&holding) } else { String::new() }
}

fn asked(named: &[&str]) -> String {
    let quoted: Vec<String> = named.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((one, [])) => format!("; did you mean {one}?"),
        Some((end, others)) => format!("; did you mean {} or {end}?", others.join(", ")),
    }
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
        let keys = ["filament.fan", "speed.wall", "walls", "jerk.wall", "retraction.length"];
        let told = |word: &str| did_you_mean(word, keys.into_iter());
        assert_eq!(told("wall"), "; did you mean `walls`, `speed.wall` or `jerk.wall`?");
        assert_eq!(told("machine.length"), "; did you mean `retraction.length`?");
        assert_eq!(told("retraction.lenght"), "; did you mean `retraction.length`?");
        assert_eq!(told("filament.flow"), "");
        let printers = ["prusa-mk3s", "prusa-mk4", "ender-3"];
        let told = |word: &str| containing(word, printers.into_iter());
        assert_eq!(told("MK3S"), "; did you mean `prusa-mk3s`?");
        assert_eq!(told("prusa"), "; did you mean `prusa-mk3s` or `prusa-mk4`?");
        assert_eq!((told("mk"), told("bambu")), (String::new(), String::new()));
        assert_eq!(nearest("skirt", ["strict", "quiet"].into_iter()), None);
        assert_eq!(nearest("same", ["same-a", "same-b"].into_iter()), None);
    }
}

//! TOML text -> the line of a text that its quotes do not close: mostly a block of G-code between single ones.

/// The line on which a text in single or double quotes begins that does not end on it, if there is one: a block
/// of several lines that was put between them.
pub(super) fn unclosed(text: &str) -> Option<usize> {
    let mut rest = text;
    let mut line = 1;
    // Whether a value or a key may begin: an apostrophe elsewhere begins no text.
    let begins = |before: &str| {
        let before = before.trim_end_matches([' ', '\t']);
        before.is_empty() || before.ends_with(['=', ',', '[', '{', '.', '\n'])
    };
    while let Some(at) = rest.find(['"', '\'', '#', '\n']) {
        let here = &rest[at..];
        let quote = &here[..1];
        if (quote == "\"" || quote == "'") && !begins(&rest[..at]) {
            return None;
        }
        let taken = match quote {
            "\n" => 1,
            "#" => here.find('\n').unwrap_or(here.len()),
            _ => {
                let open = if here.starts_with(&quote.repeat(3)) { 3 } else { 1 };
                match end_of(&here[open..], &here[..open], quote == "\"") {
                    Some(length) if open == 1 => length + 2,
                    // Up to two quotes more are part of the text.
                    Some(length) => {
                        let end = length + 6;
                        let more =
                            here[end..].bytes().take_while(|byte| *byte == quote.as_bytes()[0]);
                        end + more.count().min(2)
                    }
                    None => return (open == 1).then_some(line),
                }
            }
        };
        line += here[..taken].matches('\n').count();
        rest = &here[taken..];
    }
    None
}

/// Length of a text that ends with these quotes; one in single ones ends on its line, or not at all.
fn end_of(text: &str, quotes: &str, escapes: bool) -> Option<usize> {
    let mut escaped = false;
    for (at, character) in text.char_indices() {
        match character {
            '\n' if quotes.len() == 1 => return None,
            _ if escaped => escaped = false,
            '\\' if escapes => escaped = true,
            _ if text[at..].starts_with(quotes) => return Some(at),
            _ => {}
        }
    }
    None
}

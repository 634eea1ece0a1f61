//! Comments -> what slicers mark with them: roles, layers, widths and heights of lines.

use super::role::Role;
use super::words;

/// The meaning of a comment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mark {
    /// `;TYPE:`, `;FEATURE:`: what follows prints this.
    Role(Role),
    /// `;LAYER_CHANGE`, `;LAYER:7`: a layer begins.
    Layer,
    /// `;WIDTH:`, mm.
    Width(f64),
    /// `;HEIGHT:`, mm.
    Height(f64),
    /// `;NONPLANAR_START 3`: what follows is this patch of skin; without a number after
    /// `;NONPLANAR_END`.
    Patch(Option<u32>),
    /// `;FLAVOR:UltiGCode`: E is plastic in mm³, from here on.
    Volumes,
}

/// The meaning of a comment, given without its `;`.
pub(super) fn mark(comment: &[u8]) -> Option<Mark> {
    // Most comments mark nothing: decide by the first letter.
    let comment = comment.trim_ascii();
    let after = |prefix: &[u8]| comment.strip_prefix(prefix).map(<[u8]>::trim_ascii);
    match comment.first()? {
        b'T' => after(b"TYPE:").map(Role::of_name).map(Mark::Role),
        b'F' if comment == b"FLAVOR:UltiGCode" => Some(Mark::Volumes),
        b'F' => after(b"FEATURE:").map(Role::of_name).map(Mark::Role),
        b'L' if comment == b"LAYER_CHANGE" => Some(Mark::Layer),
        b'L' => after(b"LAYER:").map(|_| Mark::Layer),
        b'C' => (comment == b"CHANGE_LAYER").then_some(Mark::Layer),
        b'N' if comment == b"NONPLANAR_END" => Some(Mark::Patch(None)),
        b'N' => after(b"NONPLANAR_START").map(|number| Mark::Patch(Some(counted(number)))),
        b'W' => length(after(b"WIDTH:")?).map(Mark::Width),
        b'H' => length(after(b"HEIGHT:")?).map(Mark::Height),
        _ => None,
    }
}

/// A number without a fraction; 0 where none is told.
fn counted(text: &[u8]) -> u32 {
    words::number(text).0.map_or(0, |number| number as u32)
}

fn length(text: &[u8]) -> Option<f64> {
    words::number(text).0.filter(|length| *length > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_distinguished_from_talk() {
        assert_eq!(mark(b"TYPE:Perimeter"), Some(Mark::Role(Role::InnerWall)));
        assert_eq!(mark(b" FEATURE: Sparse infill"), Some(Mark::Role(Role::Infill)));
        assert_eq!(mark(b"LAYER:-2"), Some(Mark::Layer));
        assert_eq!(mark(b"LAYER_COUNT:80"), None);
        assert_eq!(mark(b"HEIGHT:0.2"), Some(Mark::Height(0.2)));
        assert_eq!(mark(b"WIDTH:x"), None);
        assert_eq!(mark(b"NONPLANAR_START 3"), Some(Mark::Patch(Some(3))));
        assert_eq!(mark(b"NONPLANAR_END"), Some(Mark::Patch(None)));
        assert_eq!(mark(b"NONPLANAR"), None);
        assert_eq!(mark(b"This is LAYER:1"), None);
        assert_eq!(mark(b""), None);
    }
}

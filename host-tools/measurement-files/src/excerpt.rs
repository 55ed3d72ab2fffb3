//! Texts of a file, short enough for a message.

/// `text` cut to what a message can carry.
#[must_use]
pub fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_is_cut() {
        assert_eq!(excerpt("ab"), "ab");
        assert_eq!(excerpt(&"µ".repeat(50)).chars().count(), 41);
    }
}

//! Text on the wire.

/// Text on the wire; longer text is cut.
pub type Text<const N: usize> = heapless::String<N>;

/// What a run that failed has left to say.
pub type LastWords = Text<LAST_WORDS>;

/// The longest that is, bytes.
pub const LAST_WORDS: usize = 160;

/// Why something is not so, for people.
pub type Reason = Text<120>;

/// Writes as much of something as fits into a [`Text`], in whole characters.
pub fn text<const N: usize>(content: impl core::fmt::Display) -> Text<N> {
    struct Cut<const N: usize>(Text<N>);
    impl<const N: usize> core::fmt::Write for Cut<N> {
        fn write_str(&mut self, more: &str) -> core::fmt::Result {
            more.chars().try_for_each(|c| self.0.push(c).map_err(|_| core::fmt::Error))
        }
    }
    let mut cut = Cut(Text::new());
    // An error says that the text is full.
    let _ = core::fmt::write(&mut cut, format_args!("{content}"));
    cut.0
}

//! The person's language.

/// A language of the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Language {
    /// English, also the fallback for all other languages.
    #[default]
    English,
    /// German.
    German,
}

/// A text in each language, in their order.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Translated(pub [String; Language::ALL.len()]);

impl Translated {
    /// The text in a language.
    #[must_use]
    pub fn in_language(&self, language: Language) -> &str {
        let Self([english, german]) = self;
        match language {
            Language::English => english,
            Language::German => german,
        }
    }
}

impl From<[&str; Language::ALL.len()]> for Translated {
    fn from(texts: [&str; Language::ALL.len()]) -> Self {
        Self(texts.map(str::to_owned))
    }
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 2] = [Self::English, Self::German];

    /// The language of a tag such as `de-AT`.
    #[must_use]
    pub fn of_tag(tag: &str) -> Self {
        let first = tag.split(['-', '_']).next().unwrap_or_default();
        if first.eq_ignore_ascii_case("de") {
            Self::German
        } else {
            Self::English
        }
    }
}

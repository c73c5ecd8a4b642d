//! What reaches a person beside the screen: the language they read, words for those who do not see, and knocks.

use app_core::app::Language;
use objc2::MainThreadMarker;
use objc2_foundation::{NSLocale, NSString};
use objc2_ui_kit::{
    UIAccessibilityAnnouncementNotification, UIAccessibilityPostNotification, UIImpactFeedbackGenerator,
};

/// The first of those that the phone is set to.
pub(crate) fn language() -> Language {
    let first = NSLocale::preferredLanguages().firstObject();
    first.map_or_else(Language::default, |tag| Language::of_tag(&tag.to_string()))
}

/// Has VoiceOver say it, if that is on.
pub(crate) fn say(words: &str) {
    let words = NSString::from_str(words);
    // SAFETY: an announcement takes a string.
    unsafe { UIAccessibilityPostNotification(UIAccessibilityAnnouncementNotification, Some(&words)) };
}

/// One short knock.
pub(crate) fn knock(main_thread: MainThreadMarker) {
    UIImpactFeedbackGenerator::new(main_thread).impactOccurred();
}

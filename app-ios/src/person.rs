//! Output to the person beside the screen, and their language: announcements and haptic pulses.

use app_core::app::Language;
use objc2::MainThreadMarker;
use objc2_foundation::{NSLocale, NSString};
use objc2_ui_kit::{
    UIAccessibilityAnnouncementNotification, UIAccessibilityPostNotification, UIImpactFeedbackGenerator,
};

/// The first supported language of the phone's list.
pub(crate) fn language() -> Language {
    let first = NSLocale::preferredLanguages().firstObject();
    first.map_or_else(Language::default, |tag| Language::of_tag(&tag.to_string()))
}

/// Has VoiceOver say the words, if it is on.
pub(crate) fn say(words: &str) {
    let words = NSString::from_str(words);
    // SAFETY: an announcement takes a string.
    unsafe { UIAccessibilityPostNotification(UIAccessibilityAnnouncementNotification, Some(&words)) };
}

/// Gives one short haptic pulse.
pub(crate) fn knock(main_thread: MainThreadMarker) {
    UIImpactFeedbackGenerator::new(main_thread).impactOccurred();
}

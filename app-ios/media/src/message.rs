//! A text over the window of a view that no longer draws.

use objc2::MainThreadOnly;
use objc2::rc::Retained;
use objc2_foundation::NSString;
use objc2_ui_kit::{NSTextAlignment, UIColor, UILabel, UIView, UIViewAutoresizing};

/// A text that covers a window until it is dropped. Touches go through it to the views below.
#[derive(Debug)]
pub struct Message(Retained<UILabel>);

impl Message {
    /// Covers the window of `view` with `words`; `None` if it has none. The label is beside the
    /// view and not within it, since that would have the view laid out again.
    #[must_use]
    pub fn over(view: &UIView, words: &str) -> Option<Self> {
        let window = view.window()?;
        let label = UILabel::new(view.mtm());
        label.setText(Some(&NSString::from_str(words)));
        label.setNumberOfLines(0);
        label.setTextAlignment(NSTextAlignment::Center);
        // The label's own colour stands out from it, by day and by night.
        label.setBackgroundColor(Some(&UIColor::systemBackgroundColor()));
        label.setAutoresizingMask(UIViewAutoresizing::FlexibleWidth | UIViewAutoresizing::FlexibleHeight);
        label.setFrame(window.bounds());
        window.addSubview(&label);
        Some(Self(label))
    }
}

impl Drop for Message {
    fn drop(&mut self) {
        self.0.removeFromSuperview();
    }
}

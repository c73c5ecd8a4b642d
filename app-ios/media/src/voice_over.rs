//! The interface for VoiceOver, by AccessKit's adapter for UIKit.

use accesskit_ios::SubclassingAdapter;
use app_core::interface::accesskit::{
    ActionHandler, ActionRequest, ActivationHandler, DeactivationHandler, TreeUpdate,
};
use objc2_ui_kit::UIView;

/// Lets VoiceOver read the interface that is drawn on a view, and act on it.
pub struct VoiceOver(SubclassingAdapter);

/// VoiceOver comes and goes: it gets the tree with the next picture, and nothing remains of it.
struct Comes;

impl ActivationHandler for Comes {
    fn request_initial_tree(&mut self) -> Option<TreeUpdate> {
        None
    }
}

impl DeactivationHandler for Comes {
    fn deactivate_accessibility(&mut self) {}
}

struct Tell<F>(F);

impl<F: FnMut(ActionRequest)> ActionHandler for Tell<F> {
    fn do_action(&mut self, request: ActionRequest) {
        (self.0)(request);
    }
}

impl VoiceOver {
    /// Attaches to a view that was not shown yet; the view is retained. `tell` gets VoiceOver's
    /// actions, on the main thread.
    pub fn over(view: &UIView, tell: impl FnMut(ActionRequest) + 'static) -> Self {
        let pointer = std::ptr::from_ref(view).cast_mut().cast();
        // SAFETY: a pointer to a view that is alive, and that the adapter retains.
        Self(unsafe { SubclassingAdapter::new(pointer, Comes, Tell(tell), Comes) })
    }

    /// Gives VoiceOver the tree of a picture, if it is on.
    pub fn update(&self, tree: &TreeUpdate) {
        if let Some(events) = self.0.update_if_active(|| tree.clone()) {
            events.raise();
        }
    }
}

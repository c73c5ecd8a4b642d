//! The passes in the order they run, and which of them a change asks for.

/// Which of the two paths a pass belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// When the place or the view of it is new.
    Capture,
    /// For every picture.
    Frame,
}

impl Path {
    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Capture => "capture",
            Self::Frame => "frame",
        }
    }
}

/// How much of a frame is new; each takes in those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Only the pose that is shown.
    Pose,
    /// The camera's picture.
    Picture,
    /// The camera's place, or the part of the picture that is worked on.
    View,
    /// Nothing is known yet.
    Place,
}

/// A pass on its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedPass {
    /// The pass's name.
    pub name: &'static str,
    /// Its path.
    pub path: Path,
    /// Whether it also follows each new picture of a known view, as part of the frame path.
    pub follows_picture: bool,
}

const fn capture(name: &'static str) -> PlannedPass {
    PlannedPass {
        name,
        path: Path::Capture,
        follows_picture: false,
    }
}

const fn picture(name: &'static str) -> PlannedPass {
    PlannedPass {
        follows_picture: true,
        ..capture(name)
    }
}

const fn frame(name: &'static str) -> PlannedPass {
    PlannedPass {
        name,
        path: Path::Frame,
        follows_picture: true,
    }
}

/// The model, in order.
pub(super) const PASSES: &[PlannedPass] = &[
    capture("self_shadow"),
    capture("object"),
    capture("evidence"),
    capture("occlusion"),
    capture("visibility"),
    capture("plate"),
    capture("lit"),
    capture("estimate"),
    picture("fit"),
    picture("fit_solve"),
    capture("withhold"),
    picture("residual"),
    picture("fill"),
    picture("detail"),
    picture("tint"),
    picture("tint_fill"),
    picture("appearance"),
    frame("occlusion"),
    frame("visibility"),
    frame("self_shadow"),
    frame("motion"),
    frame("toy"),
    frame("coverage"),
    frame("composite"),
    frame("present"),
];

/// The published method, in order.
pub(super) const PUBLISHED_PASSES: &[PlannedPass] = &[
    picture("plate"),
    capture("masks"),
    capture("warp"),
    capture("pcss"),
    capture("eligible"),
    capture("census"),
    frame("warp"),
    frame("pcss"),
    frame("search"),
    frame("box_filter"),
    frame("retarget"),
    frame("present"),
];
/// What a scene does without when one plate shows all of it.
pub(super) const ESTIMATE_PASSES: &[&str] = &["lit", "estimate"];
/// What a shadow of constant strength does without.
pub(super) const SAMPLING_PASSES: &[&str] = &["census", "search", "box_filter"];

/// Which of the planned passes run when that much is new, all but `present`, and on which path.
///
/// What a new picture of a known view needs anew, such as the toy's colours and the light's levels, counts as the frame's.
pub fn runs(passes: &[PlannedPass], change: Change) -> impl Iterator<Item = (Path, &'static str)> + '_ {
    passes
        .iter()
        .filter(|pass| pass.name != "present")
        .filter_map(move |pass| {
            let is_pictures = change == Change::Picture && pass.follows_picture;
            if pass.path == Path::Frame || change >= Change::View {
                Some((pass.path, pass.name))
            } else {
                is_pictures.then_some((Path::Frame, pass.name))
            }
        })
}

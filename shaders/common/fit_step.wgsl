// One step of the iteratively reweighted least squares.

const SUBJECT_RECEIVER: u32 = 0u;
const SUBJECT_TOY: u32 = 1u;
const SUBJECT_INTENSITIES: u32 = 2u;

// The difference between frame and plate if no light is known: no unknown of it is fitted.
const UNSHADED_COLUMN: u32 = 2u;

struct FitStep {
  // 0 in the first step: there is no solution yet, and all weights are 1.
  is_reweighted: u32,
  // Workgroups per channel, each of which writes one row of sums per channel.
  n_rows: u32,
  // Number of unknowns: two, and one per light.
  n_columns: u32,
  subject: u32,
  // The receiver that is fitted, for SUBJECT_RECEIVER.
  receiver: u32,
  // Sampling stride in pixels along each side.
  stride_px: u32,
  // 1 in the last step: its sums are accumulated.
  is_last: u32,
  // Ratio of this picture's exposure to the previous one's, for SUBJECT_INTENSITIES; 1 once it is
  // applied to the gain.
  exposure_ratio: f32,
}

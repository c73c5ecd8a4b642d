//! Output to the person beside the screen: announcements and haptic pulses. Both are requested on
//! the activities' thread.

use jni::errors::Result;
use jni::objects::{JObject, JValue};
use jni::{Env, jni_sig, jni_str};

use super::display::decor_view;

/// The constant `HapticFeedbackConstants.VIRTUAL_KEY`.
const KNOCK: i32 = 1;

/// Has TalkBack say the words, if it is on: `announceForAccessibility`.
pub fn say(env: &mut Env<'_>, activity: &JObject<'_>, words: &str) -> Result<()> {
    let view = decor_view(env, activity)?;
    let words = env.new_string(words)?;
    env.call_method(
        &view,
        jni_str!("announceForAccessibility"),
        jni_sig!("(Ljava/lang/CharSequence;)V"),
        &[JValue::Object(&words)],
    )?;
    Ok(())
}

/// Gives one short haptic pulse, if the person has not turned them off: `performHapticFeedback`.
pub fn knock(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<()> {
    let view = decor_view(env, activity)?;
    env.call_method(
        &view,
        jni_str!("performHapticFeedback"),
        jni_sig!("(I)Z"),
        &[JValue::Int(KNOCK)],
    )?;
    Ok(())
}

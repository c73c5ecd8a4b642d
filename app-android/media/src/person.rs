//! What reaches a person beside the screen: words for those who do not see, and knocks. Both are asked for on the thread that activities
//! live on.

use jni::errors::Result;
use jni::objects::{JObject, JValue};
use jni::{Env, jni_sig, jni_str};

use super::display::decor_view;

/// `HapticFeedbackConstants.VIRTUAL_KEY`.
const KNOCK: i32 = 1;

/// Has TalkBack say it, if that is on: `announceForAccessibility`.
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

/// One short knock, if the person has not switched them off: `performHapticFeedback`.
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

//! Android's own settings of this app.

use jni::errors::Result;
use jni::objects::{JObject, JValue};
use jni::{Env, jni_sig, jni_str};

const DETAILS: &str = "android.settings.APPLICATION_DETAILS_SETTINGS";

/// Calls `startActivity(new Intent(DETAILS, Uri.parse("package:" + getPackageName())))`.
pub fn show(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<()> {
    let scheme = env.new_string("package")?;
    let details = env.new_string(DETAILS)?;
    let package = env
        .call_method(
            activity,
            jni_str!("getPackageName"),
            jni_sig!("()Ljava/lang/String;"),
            &[],
        )?
        .l()?;
    let of_app = env
        .call_static_method(
            jni_str!("android/net/Uri"),
            jni_str!("fromParts"),
            jni_sig!("(Ljava/lang/String;Ljava/lang/String;Ljava/lang/String;)Landroid/net/Uri;"),
            &[
                JValue::Object(&scheme),
                JValue::Object(&package),
                JValue::Object(&JObject::null()),
            ],
        )?
        .l()?;
    let intent = env.new_object(
        jni_str!("android/content/Intent"),
        jni_sig!("(Ljava/lang/String;Landroid/net/Uri;)V"),
        &[JValue::Object(&details), JValue::Object(&of_app)],
    )?;
    env.call_method(
        activity,
        jni_str!("startActivity"),
        jni_sig!("(Landroid/content/Intent;)V"),
        &[JValue::Object(&intent)],
    )?;
    Ok(())
}

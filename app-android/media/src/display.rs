//! Values of the activity's display, and short messages over it.

use jni::errors::Result;
use jni::objects::{JObject, JValue};
use jni::strings::JNIStr;
use jni::{Env, jni_sig, jni_str};

/// The constant `Toast.LENGTH_LONG`.
const LONG: i32 = 1;

/// Calls a method without arguments that returns a number.
fn number(env: &mut Env<'_>, of: &JObject<'_>, method: &JNIStr) -> Result<i32> {
    env.call_method(of, method, jni_sig!("()I"), &[])?.i()
}

/// Calls `getWindow().getDecorView()`.
pub(crate) fn decor_view<'local>(env: &mut Env<'local>, activity: &JObject<'_>) -> Result<JObject<'local>> {
    let window = env
        .call_method(
            activity,
            jni_str!("getWindow"),
            jni_sig!("()Landroid/view/Window;"),
            &[],
        )?
        .l()?;
    env.call_method(
        &window,
        jni_str!("getDecorView"),
        jni_sig!("()Landroid/view/View;"),
        &[],
    )?
    .l()
}

/// `getWindow().getDecorView().getRootWindowInsets()` and its `getDisplayCutout()`: insets that
/// bars and cut-outs cover; `None` while the window is not shown. Both exist since Android 9.
pub fn covered(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<Option<[i32; 4]>> {
    let view = decor_view(env, activity)?;
    let insets = env
        .call_method(
            &view,
            jni_str!("getRootWindowInsets"),
            jni_sig!("()Landroid/view/WindowInsets;"),
            &[],
        )?
        .l()?;
    if insets.is_null() {
        return Ok(None);
    }
    let cutout = env
        .call_method(
            &insets,
            jni_str!("getDisplayCutout"),
            jni_sig!("()Landroid/view/DisplayCutout;"),
            &[],
        )?
        .l()?;
    let sides = [
        (jni_str!("getSystemWindowInsetLeft"), jni_str!("getSafeInsetLeft")),
        (jni_str!("getSystemWindowInsetTop"), jni_str!("getSafeInsetTop")),
        (
            jni_str!("getSystemWindowInsetRight"),
            jni_str!("getSafeInsetRight"),
        ),
        (
            jni_str!("getSystemWindowInsetBottom"),
            jni_str!("getSafeInsetBottom"),
        ),
    ];
    let mut covered = [0; 4];
    for (side, (of_bars, of_cutout)) in covered.iter_mut().zip(sides) {
        *side = number(env, &insets, of_bars)?;
        if !cutout.is_null() {
            *side = number(env, &cutout, of_cutout)?.max(*side);
        }
    }
    Ok(Some(covered))
}

/// Calls `getWindowManager().getDefaultDisplay().getRotation()`.
pub fn rotation(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<i32> {
    let manager = env
        .call_method(
            activity,
            jni_str!("getWindowManager"),
            jni_sig!("()Landroid/view/WindowManager;"),
            &[],
        )?
        .l()?;
    let display = env
        .call_method(
            &manager,
            jni_str!("getDefaultDisplay"),
            jni_sig!("()Landroid/view/Display;"),
            &[],
        )?
        .l()?;
    number(env, &display, jni_str!("getRotation"))
}

/// Reads `getResources().getConfiguration().fontScale`. Android recreates the activity if it
/// changes.
pub fn font_scale(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<f32> {
    let resources = env
        .call_method(
            activity,
            jni_str!("getResources"),
            jni_sig!("()Landroid/content/res/Resources;"),
            &[],
        )?
        .l()?;
    let configuration = env
        .call_method(
            &resources,
            jni_str!("getConfiguration"),
            jni_sig!("()Landroid/content/res/Configuration;"),
            &[],
        )?
        .l()?;
    env.get_field(&configuration, jni_str!("fontScale"), jni_sig!("F"))?
        .f()
}

/// Calls `Toast.makeText(…).show()`, on the activities' thread.
pub fn toast(env: &mut Env<'_>, activity: &JObject<'_>, words: &str) -> Result<()> {
    let words = env.new_string(words)?;
    let toast = env
        .call_static_method(
            jni_str!("android/widget/Toast"),
            jni_str!("makeText"),
            jni_sig!("(Landroid/content/Context;Ljava/lang/CharSequence;I)Landroid/widget/Toast;"),
            &[
                JValue::Object(activity),
                JValue::Object(&words),
                JValue::Int(LONG),
            ],
        )?
        .l()?;
    env.call_method(&toast, jni_str!("show"), jni_sig!("()V"), &[])?;
    Ok(())
}

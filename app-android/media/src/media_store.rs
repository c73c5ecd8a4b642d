//! Copies of files that other apps can find: Android's media store, since Android 10 without a
//! permission; and the dialog for sharing them.

use std::fs::File;
use std::io;
use std::os::fd::{FromRawFd, OwnedFd};
use std::path::{Path, PathBuf};

use jni::errors::{Error, JniError, Result};
use jni::objects::{JObject, JValue};
use jni::strings::JNIString;
use jni::{Env, jni_sig, jni_str};

use crate::stored::stored;

const SEND: &str = "android.intent.action.SEND_MULTIPLE";
const STREAM: &str = "android.intent.extra.STREAM";
/// `Intent.FLAG_GRANT_READ_URI_PERMISSION`.
const MAY_READ: i32 = 1;

/// Copies a file into the store and returns its address there. Until the copy is whole, no other app
/// sees it, and one that cannot be completed is removed.
///
/// # Errors
/// If there is no such store, as before Android 10, or no space.
pub fn copy<'local>(env: &mut Env<'local>, activity: &JObject<'_>, file: &Path) -> Result<JObject<'local>> {
    let resolver = env
        .call_method(
            activity,
            jni_str!("getContentResolver"),
            jni_sig!("()Landroid/content/ContentResolver;"),
            &[],
        )?
        .l()?;
    let address = insert(env, &resolver, file)?;
    let whole = fill(env, (&resolver, &address), file).and_then(|()| publish(env, (&resolver, &address)));
    if let Err(error) = whole {
        env.exception_clear();
        delete(env, (&resolver, &address))?;
        return Err(error);
    }
    Ok(address)
}

/// Adds a pending entry for a file.
fn insert<'local>(env: &mut Env<'local>, resolver: &JObject<'_>, file: &Path) -> Result<JObject<'local>> {
    let stored = stored(file);
    let values = pending(env, true)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    for (column, value) in [
        ("_display_name", name.as_ref()),
        ("mime_type", stored.mime),
        ("relative_path", stored.folder),
    ] {
        let (column, value) = (env.new_string(column)?, env.new_string(value)?);
        env.call_method(
            &values,
            jni_str!("put"),
            jni_sig!("(Ljava/lang/String;Ljava/lang/String;)V"),
            &[JValue::Object(&column), JValue::Object(&value)],
        )?;
    }
    let volume = env.new_string("external")?;
    let table = env
        .call_static_method(
            JNIString::from(stored.table),
            jni_str!("getContentUri"),
            jni_sig!("(Ljava/lang/String;)Landroid/net/Uri;"),
            &[JValue::Object(&volume)],
        )?
        .l()?;
    let address = env
        .call_method(
            resolver,
            jni_str!("insert"),
            jni_sig!("(Landroid/net/Uri;Landroid/content/ContentValues;)Landroid/net/Uri;"),
            &[JValue::Object(&table), JValue::Object(&values)],
        )?
        .l()?;
    if address.is_null() {
        return Err(Error::NullPtr("the address of a new entry"));
    }
    Ok(address)
}

/// Values of an entry with its column `is_pending`.
fn pending<'local>(env: &mut Env<'local>, is_pending: bool) -> Result<JObject<'local>> {
    let values = env.new_object(jni_str!("android/content/ContentValues"), jni_sig!("()V"), &[])?;
    let column = env.new_string("is_pending")?;
    let flag = env
        .call_static_method(
            jni_str!("java/lang/Integer"),
            jni_str!("valueOf"),
            jni_sig!("(I)Ljava/lang/Integer;"),
            &[JValue::Int(i32::from(is_pending))],
        )?
        .l()?;
    env.call_method(
        &values,
        jni_str!("put"),
        jni_sig!("(Ljava/lang/String;Ljava/lang/Integer;)V"),
        &[JValue::Object(&column), JValue::Object(&flag)],
    )?;
    Ok(values)
}

/// Writes a file's bytes into an entry.
fn fill(env: &mut Env<'_>, (resolver, address): (&JObject<'_>, &JObject<'_>), file: &Path) -> Result<()> {
    let mode = env.new_string("w")?;
    let opened = env
        .call_method(
            resolver,
            jni_str!("openFileDescriptor"),
            jni_sig!("(Landroid/net/Uri;Ljava/lang/String;)Landroid/os/ParcelFileDescriptor;"),
            &[JValue::Object(address), JValue::Object(&mode)],
        )?
        .l()?;
    let descriptor = env
        .call_method(&opened, jni_str!("detachFd"), jni_sig!("()I"), &[])?
        .i()?;
    // SAFETY: the descriptor is open, and Java has detached it.
    let mut copy = File::from(unsafe { OwnedFd::from_raw_fd(descriptor) });
    let copied = File::open(file).and_then(|mut file| io::copy(&mut file, &mut copy));
    copied.map(drop).map_err(|error| {
        eprintln!("app-android: {} cannot be copied: {error}", file.display());
        Error::JniCall(JniError::Unknown)
    })
}

/// Shows a whole entry to other apps.
fn publish(env: &mut Env<'_>, (resolver, address): (&JObject<'_>, &JObject<'_>)) -> Result<()> {
    let values = pending(env, false)?;
    let (no_rows, no_values) = (JObject::null(), JObject::null());
    env.call_method(
        resolver,
        jni_str!("update"),
        jni_sig!("(Landroid/net/Uri;Landroid/content/ContentValues;Ljava/lang/String;[Ljava/lang/String;)I"),
        &[
            JValue::Object(address),
            JValue::Object(&values),
            JValue::Object(&no_rows),
            JValue::Object(&no_values),
        ],
    )?;
    Ok(())
}

fn delete(env: &mut Env<'_>, (resolver, address): (&JObject<'_>, &JObject<'_>)) -> Result<()> {
    let (no_rows, no_values) = (JObject::null(), JObject::null());
    env.call_method(
        resolver,
        jni_str!("delete"),
        jni_sig!("(Landroid/net/Uri;Ljava/lang/String;[Ljava/lang/String;)I"),
        &[
            JValue::Object(address),
            JValue::Object(&no_rows),
            JValue::Object(&no_values),
        ],
    )?;
    Ok(())
}

/// `startActivity(Intent.createChooser(new Intent(SEND_MULTIPLE)…, null))`.
///
/// # Errors
/// As [`copy`].
pub fn share(env: &mut Env<'_>, activity: &JObject<'_>, files: &[PathBuf]) -> Result<()> {
    let addresses = env.new_object(jni_str!("java/util/ArrayList"), jni_sig!("()V"), &[])?;
    for file in files {
        let address = copy(env, activity, file)?;
        env.call_method(
            &addresses,
            jni_str!("add"),
            jni_sig!("(Ljava/lang/Object;)Z"),
            &[JValue::Object(&address)],
        )?;
    }
    let (action, any, stream) = (
        env.new_string(SEND)?,
        env.new_string("*/*")?,
        env.new_string(STREAM)?,
    );
    let intent = env.new_object(
        jni_str!("android/content/Intent"),
        jni_sig!("(Ljava/lang/String;)V"),
        &[JValue::Object(&action)],
    )?;
    env.call_method(
        &intent,
        jni_str!("setType"),
        jni_sig!("(Ljava/lang/String;)Landroid/content/Intent;"),
        &[JValue::Object(&any)],
    )?;
    env.call_method(
        &intent,
        jni_str!("putParcelableArrayListExtra"),
        jni_sig!("(Ljava/lang/String;Ljava/util/ArrayList;)Landroid/content/Intent;"),
        &[JValue::Object(&stream), JValue::Object(&addresses)],
    )?;
    env.call_method(
        &intent,
        jni_str!("addFlags"),
        jni_sig!("(I)Landroid/content/Intent;"),
        &[JValue::Int(MAY_READ)],
    )?;
    let chooser = env
        .call_static_method(
            jni_str!("android/content/Intent"),
            jni_str!("createChooser"),
            jni_sig!("(Landroid/content/Intent;Ljava/lang/CharSequence;)Landroid/content/Intent;"),
            &[JValue::Object(&intent), JValue::Object(&JObject::null())],
        )?
        .l()?;
    env.call_method(
        activity,
        jni_str!("startActivity"),
        jni_sig!("(Landroid/content/Intent;)V"),
        &[JValue::Object(&chooser)],
    )?;
    Ok(())
}

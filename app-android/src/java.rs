//! Calls that need Java: the camera's permission, the system's settings, and ARCore's pointers.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use android_activity::{AndroidApp, WindowManagerFlags};
use android_media::heat::Thermometer;
use android_media::{display, media_store, person, settings};
use app_core::app::{Language, Permission};
use arcore::java::{Java, JavaHost};
use jni::errors::Result;
use jni::objects::{JObject, JValue};
use jni::refs::Global;
use jni::{Env, JavaVM, jni_sig, jni_str};

use crate::phone::{Phone, permission};
use app_shell::guard::guarded;

const CAMERA: &str = "android.permission.CAMERA";
/// The constant `PackageManager.PERMISSION_GRANTED`.
const GRANTED: i32 = 0;
/// Code of the answer, which a native activity never receives; the permission is read on resume.
const REQUEST: i32 = 1;

/// The phone, through its activity.
pub(crate) struct Activity {
    app: AndroidApp,
    was_asked: bool,
    /// Insets that bars and cut-outs cover, as last reported by Java's thread.
    insets_px: Arc<Mutex<Option<[i32; 4]>>>,
    thermometer: Option<Thermometer>,
}

impl Activity {
    /// The activity of the app that `android_main` was called with.
    pub(crate) fn new(app: AndroidApp) -> Self {
        Self {
            app,
            was_asked: false,
            insets_px: Arc::default(),
            thermometer: Thermometer::find(),
        }
    }

    /// Insets that bars and cut-outs cover, at the left, top, right and bottom; `None` before the
    /// first report.
    pub(crate) fn insets_px(&self) -> Option<[i32; 4]> {
        *self.insets_px.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests a new report of the insets.
    fn look_at_insets(&self) {
        let (app, told) = (self.app.clone(), Arc::clone(&self.insets_px));
        self.app.run_on_java_main_thread(Box::new(move || {
            let insets_px = guarded("a call of Java", || with_java(&app, display::covered));
            if let Some(Ok(insets_px)) = insets_px {
                *told.lock().unwrap_or_else(PoisonError::into_inner) = insets_px;
            }
        }));
    }

    /// Lets `act` call Java on the activities' thread, and logs a failure.
    fn on_java_thread(&self, act: impl FnOnce(&mut Env<'_>, &JObject<'_>) -> Result<()> + Send + 'static) {
        let app = self.app.clone();
        self.app.run_on_java_main_thread(Box::new(move || {
            if let Some(Err(error)) = guarded("a call of Java", || with_java(&app, act)) {
                eprintln!("app-android: Java refused: {error}");
            }
        }));
    }

    /// Lets `act` call Java on a separate thread, which may take long, and logs a failure.
    fn on_thread(&self, act: impl FnOnce(&mut Env<'_>, &JObject<'_>) -> Result<()> + Send + 'static) {
        let app = self.app.clone();
        let thread = thread::Builder::new().spawn(move || {
            if let Some(Err(error)) = guarded("a thread", || with_java(&app, act)) {
                eprintln!("app-android: Java refused: {error}");
            }
        });
        if let Err(error) = thread {
            eprintln!("app-android: no thread for Java: {error}");
        }
    }
}

/// Lets `act` call Java on this thread, which stays attached. An exception is cleared and becomes an error.
fn with_java<T>(app: &AndroidApp, act: impl FnOnce(&mut Env<'_>, &JObject<'_>) -> Result<T>) -> Result<T> {
    // SAFETY: the pointer is that of the one virtual machine of this process.
    let vm = unsafe { JavaVM::from_raw(app.vm_as_ptr().cast()) };
    vm.attach_current_thread(|env| {
        let raw: jni::sys::jobject = app.activity_as_ptr().cast();
        // SAFETY: a global reference to the activity, which `app` keeps for as long as it lives, and which is only lent.
        let activity = unsafe { env.as_cast_raw::<Global<JObject<'static>>>(&raw)? };
        let result = act(env, activity.as_ref());
        if result.is_err() {
            env.exception_clear();
        }
        result
    })
}

/// The phone's language.
pub(crate) fn language(app: &AndroidApp) -> Language {
    let language = app.config().language();
    language
        .as_deref()
        .map_or_else(Language::default, Language::of_tag)
}

/// Scale of letters that the person has set.
pub(crate) fn font_scale(app: &AndroidApp) -> f32 {
    with_java(app, display::font_scale).unwrap_or(1.0)
}

/// Shows a short message on the screen, even without the activity: `Toast.makeText(…).show()`.
pub(crate) fn say(app: &AndroidApp, words: &'static str) {
    let of_java = app.clone();
    app.run_on_java_main_thread(Box::new(move || {
        let said = guarded("a call of Java", || {
            with_java(&of_java, |env, activity| display::toast(env, activity, words))
        });
        if let Some(Err(error)) = said {
            eprintln!("app-android: Java refused: {error}");
        }
    }));
}

/// Whether the camera may be used, and whether Android recommends an explanation.
fn permission_of(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<(bool, bool)> {
    let name = env.new_string(CAMERA)?;
    let granted = env.call_method(
        activity,
        jni_str!("checkSelfPermission"),
        jni_sig!("(Ljava/lang/String;)I"),
        &[JValue::Object(&name)],
    )?;
    let may_explain = env.call_method(
        activity,
        jni_str!("shouldShowRequestPermissionRationale"),
        jni_sig!("(Ljava/lang/String;)Z"),
        &[JValue::Object(&name)],
    )?;
    Ok((granted.i()? == GRANTED, may_explain.z()?))
}

fn ask(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<()> {
    let name = env.new_string(CAMERA)?;
    let names = env.new_object_array(1, jni_str!("java/lang/String"), &name)?;
    env.call_method(
        activity,
        jni_str!("requestPermissions"),
        jni_sig!("([Ljava/lang/String;I)V"),
        &[JValue::Object(&names), JValue::Int(REQUEST)],
    )?;
    Ok(())
}

fn finish(env: &mut Env<'_>, activity: &JObject<'_>) -> Result<()> {
    env.call_method(activity, jni_str!("finish"), jni_sig!("()V"), &[])?;
    Ok(())
}

impl JavaHost for Activity {
    fn java(&mut self) -> Java {
        let env = with_java(&self.app, |env, _| Ok(env.get_raw()));
        Java {
            // Without an environment ARCore returns its own error.
            env: env.map_or(std::ptr::null_mut(), |env| env.cast()),
            activity: self.app.activity_as_ptr(),
        }
    }
}

impl Phone for Activity {
    fn permission(&mut self) -> Permission {
        let (is_granted, may_explain) = with_java(&self.app, permission_of).unwrap_or_default();
        permission(is_granted, self.was_asked, may_explain)
    }

    fn ask_for_camera(&mut self) {
        self.was_asked = true;
        self.on_java_thread(ask);
    }

    fn open_settings(&mut self) {
        self.on_java_thread(settings::show);
    }

    fn leave(&mut self) {
        self.on_java_thread(finish);
    }

    fn language(&self) -> Language {
        language(&self.app)
    }

    fn say(&mut self, words: String) {
        self.on_java_thread(move |env, activity| person::say(env, activity, &words));
    }

    fn knock(&mut self) {
        self.on_java_thread(person::knock);
    }

    fn keep_awake(&mut self, is_awake: bool) {
        let (flag, none) = (WindowManagerFlags::KEEP_SCREEN_ON, WindowManagerFlags::empty());
        let (add, remove) = if is_awake { (flag, none) } else { (none, flag) };
        self.app.set_window_flags(add, remove);
    }

    fn thermal_status(&mut self) -> Option<i32> {
        self.thermometer.as_ref().map(Thermometer::status)
    }

    fn rotation(&mut self) -> i32 {
        // This is called several times a second while there is a window.
        self.look_at_insets();
        // The activity's natural orientation is landscape.
        with_java(&self.app, display::rotation).unwrap_or(1)
    }

    fn folder(&self) -> Option<PathBuf> {
        self.app
            .external_data_path()
            .or_else(|| self.app.internal_data_path())
    }

    fn show_in_gallery(&mut self, file: PathBuf) {
        self.on_thread(move |env, activity| media_store::copy(env, activity, &file).map(drop));
    }

    fn share(&mut self, files: Vec<PathBuf>, tell: impl FnOnce(bool) + Send + 'static) {
        self.on_thread(move |env, activity| {
            let shared = media_store::share(env, activity, &files);
            tell(shared.is_ok());
            shared
        });
    }

    fn own_folder(&self) -> Option<PathBuf> {
        self.app.internal_data_path()
    }
}

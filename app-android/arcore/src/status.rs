//! ARCore's results, in words for the person who holds the phone.

use app_core::app::{ArSession, Permission, ShellEvent, Translated};
use app_core::camera_frame::Tracking;

use super::ffi::{ArAvailability, ArStatus, ArTrackingFailureReason};

/// `AR_SUCCESS`.
pub const SUCCESS: ArStatus = 0;
/// The failure of a function that created nothing and reported no status.
pub(super) const NOTHING: Failure = Failure(-2);
/// `AR_ERROR_UNSUPPORTED_CONFIGURATION`.
pub const UNSUPPORTED_CONFIGURATION: ArStatus = -8;
/// `AR_ERROR_CAMERA_PERMISSION_NOT_GRANTED`.
pub const PERMISSION_NOT_GRANTED: ArStatus = -9;
/// `AR_ERROR_DEADLINE_EXCEEDED`.
pub const DEADLINE_EXCEEDED: ArStatus = -10;
/// `AR_ERROR_RESOURCE_EXHAUSTED`.
pub const RESOURCE_EXHAUSTED: ArStatus = -11;
/// `AR_ERROR_NOT_YET_AVAILABLE`.
pub const NOT_YET_AVAILABLE: ArStatus = -12;

/// `AR_ERROR_CAMERA_NOT_AVAILABLE`.
pub const CAMERA_NOT_AVAILABLE: ArStatus = -13;

/// The remedy for a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// Return to the app, which then tries again.
    Return,
    /// Allow the camera in the phone's settings.
    AllowCamera,
    /// Install or update Google Play Services for AR.
    Install,
    /// Update this app.
    UpdateApp,
    /// There is none on this phone.
    None,
    /// An error of this app: the person should send its log.
    Report,
}

impl Remedy {
    /// Text for the person.
    #[must_use]
    pub fn words(self) -> InEachLanguage {
        match self {
            Self::Return => [
                "Start over, or leave the app and come back.",
                "Beginne von vorn, oder verlass die App und komm zurück.",
            ],
            Self::AllowCamera => [
                "Allow it in the system's settings.",
                "Erlaube es in den Einstellungen.",
            ],
            Self::Install => [
                "Install or update it from the Play Store: start over, and it is offered again.",
                "Installiere oder aktualisiere sie aus dem Play Store: Beginne von vorn, dann wird es wieder angeboten.",
            ],
            Self::UpdateApp => ["Update this app.", "Aktualisiere diese App."],
            Self::None => ["Another phone is needed.", "Es braucht ein anderes Telefon."],
            Self::Report => [
                "Start over. If that does not help, hand on the log from the menu.",
                "Beginne von vorn. Hilft das nicht, gib das Log aus dem Menü weiter.",
            ],
        }
    }
}

/// A text in each language of [`Language`](app_core::app::Language), in their order.
pub type InEachLanguage = [&'static str; 2];

/// The disclosure that Google requires of apps with ARCore.
pub const DISCLOSURE: InEachLanguage = [
    "This application runs on Google Play Services for AR (ARCore), which is provided by Google and governed by the Google Privacy Policy (policies.google.com/privacy).",
    "Diese Anwendung läuft mit Google Play-Diensten für AR (ARCore). Diese werden von Google bereitgestellt und unterliegen der Datenschutzerklärung von Google (policies.google.com/privacy).",
];

/// Every `ArStatus` but success: its number, its name in C, the message, and the remedy.
#[rustfmt::skip]
pub const STATUSES: &[(ArStatus, &str, InEachLanguage, Remedy)] = &[
    (-1, "AR_ERROR_INVALID_ARGUMENT", ["The app asked ARCore for something that makes no sense.", "Die App hat von ARCore etwas Unsinniges verlangt."], Remedy::Report),
    (-2, "AR_ERROR_FATAL", ["ARCore failed and cannot go on.", "ARCore ist ausgefallen und kann nicht weitermachen."], Remedy::Return),
    (-3, "AR_ERROR_SESSION_PAUSED", ["Tracking is paused.", "Das Tracking ist angehalten."], Remedy::Return),
    (-4, "AR_ERROR_SESSION_NOT_PAUSED", ["The app changed tracking while it was running.", "Die App hat das Tracking geändert, während es lief."], Remedy::Report),
    (-5, "AR_ERROR_NOT_TRACKING", ["The phone does not know where it is. Move it slowly over the table.", "Das Telefon weiß nicht, wo es ist. Bewege es langsam über den Tisch."], Remedy::Return),
    (-6, "AR_ERROR_TEXTURE_NOT_SET", ["The app requested the camera's picture in an unsupported form.", "Die App hat das Bild der Kamera in einer Form verlangt, die es nicht gibt."], Remedy::Report),
    (-7, "AR_ERROR_MISSING_GL_CONTEXT", ["ARCore asks for OpenGL, which this app does not use.", "ARCore verlangt OpenGL, das diese App nicht benutzt."], Remedy::Report),
    (UNSUPPORTED_CONFIGURATION, "AR_ERROR_UNSUPPORTED_CONFIGURATION", ["This phone's ARCore lacks a feature that the app needs.", "Dem ARCore dieses Telefons fehlt etwas, das die App braucht."], Remedy::None),
    (PERMISSION_NOT_GRANTED, "AR_ERROR_CAMERA_PERMISSION_NOT_GRANTED", ["The app may not use the camera.", "Die App darf die Kamera nicht benutzen."], Remedy::AllowCamera),
    (DEADLINE_EXCEEDED, "AR_ERROR_DEADLINE_EXCEEDED", ["A picture of the camera came too late.", "Ein Bild der Kamera kam zu spät."], Remedy::Return),
    (RESOURCE_EXHAUSTED, "AR_ERROR_RESOURCE_EXHAUSTED", ["The camera has no room for another picture.", "Die Kamera hat keinen Platz für ein weiteres Bild."], Remedy::Return),
    (NOT_YET_AVAILABLE, "AR_ERROR_NOT_YET_AVAILABLE", ["The camera is starting.", "Die Kamera startet."], Remedy::Return),
    (CAMERA_NOT_AVAILABLE, "AR_ERROR_CAMERA_NOT_AVAILABLE", ["Another app uses the camera. Close it.", "Eine andere App benutzt die Kamera. Schließe sie."], Remedy::Return),
    (-14, "AR_ERROR_CLOUD_ANCHORS_NOT_CONFIGURED", ["ARCore expects anchors in the cloud, which this app does not use.", "ARCore erwartet Anker in der Cloud, die diese App nicht benutzt."], Remedy::Report),
    (-15, "AR_ERROR_INTERNET_PERMISSION_NOT_GRANTED", ["ARCore expects the internet, which this app does not use.", "ARCore erwartet das Internet, das diese App nicht benutzt."], Remedy::Report),
    (-16, "AR_ERROR_ANCHOR_NOT_SUPPORTED_FOR_HOSTING", ["ARCore cannot share this anchor, which this app does not ask for.", "ARCore kann diesen Anker nicht teilen, was diese App nicht verlangt."], Remedy::Report),
    (-17, "AR_ERROR_IMAGE_INSUFFICIENT_QUALITY", ["The card's picture has too little in it to be found.", "Im Bild der Karte ist zu wenig, um sie zu finden."], Remedy::Report),
    (-18, "AR_ERROR_DATA_INVALID_FORMAT", ["ARCore cannot read the data that the app gave it.", "ARCore kann die Daten der App nicht lesen."], Remedy::Report),
    (-19, "AR_ERROR_DATA_UNSUPPORTED_VERSION", ["ARCore is too old for the data that the app gave it.", "ARCore ist zu alt für die Daten der App."], Remedy::Install),
    (-20, "AR_ERROR_ILLEGAL_STATE", ["The app called ARCore at a wrong moment.", "Die App hat ARCore im falschen Moment aufgerufen."], Remedy::Report),
    (-21, "AR_ERROR_FINE_LOCATION_PERMISSION_NOT_GRANTED", ["ARCore expects the phone's location, which this app does not use.", "ARCore erwartet den Standort des Telefons, den diese App nicht benutzt."], Remedy::Report),
    (-22, "AR_ERROR_GOOGLE_PLAY_SERVICES_LOCATION_LIBRARY_NOT_LINKED", ["ARCore expects a library for locations, which this app does not use.", "ARCore erwartet eine Bibliothek für Standorte, die diese App nicht benutzt."], Remedy::Report),
    (-23, "AR_ERROR_RECORDING_FAILED", ["ARCore's recording failed.", "Die Aufnahme von ARCore ist fehlgeschlagen."], Remedy::Report),
    (-24, "AR_ERROR_PLAYBACK_FAILED", ["ARCore's playback failed.", "Die Wiedergabe von ARCore ist fehlgeschlagen."], Remedy::Report),
    (-25, "AR_ERROR_SESSION_UNSUPPORTED", ["ARCore's session does not support the app's request.", "ARCore kann nicht, was die App verlangt."], Remedy::Report),
    (-26, "AR_ERROR_METADATA_NOT_FOUND", ["The camera does not report the metadata of its picture.", "Die Kamera meldet die Daten ihres Bildes nicht."], Remedy::Report),
    (-100, "AR_UNAVAILABLE_ARCORE_NOT_INSTALLED", ["Google Play Services for AR is not installed.", "Google Play-Dienste für AR sind nicht installiert."], Remedy::Install),
    (-101, "AR_UNAVAILABLE_DEVICE_NOT_COMPATIBLE", ["This phone cannot run ARCore.", "Dieses Telefon kann ARCore nicht ausführen."], Remedy::None),
    (-103, "AR_UNAVAILABLE_APK_TOO_OLD", ["Google Play Services for AR is too old.", "Die Google Play-Dienste für AR sind zu alt."], Remedy::Install),
    (-104, "AR_UNAVAILABLE_SDK_TOO_OLD", ["This app is too old for the phone's Google Play Services for AR.", "Diese App ist zu alt für die Google Play-Dienste für AR dieses Telefons."], Remedy::UpdateApp),
    (-105, "AR_UNAVAILABLE_USER_DECLINED_INSTALLATION", ["Without Google Play Services for AR the app cannot see the table.", "Ohne Google Play-Dienste für AR sieht die App den Tisch nicht."], Remedy::Install),
];

/// A result of ARCore other than success.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure(pub ArStatus);

impl Failure {
    /// Success, or the failure.
    pub(super) fn check(status: ArStatus) -> Result<(), Self> {
        if status == SUCCESS {
            Ok(())
        } else {
            Err(Self(status))
        }
    }

    fn entry(self) -> Option<&'static (ArStatus, &'static str, InEachLanguage, Remedy)> {
        STATUSES.iter().find(|entry| entry.0 == self.0)
    }

    /// Message and remedy.
    #[must_use]
    pub fn words(self) -> Translated {
        let told = match self.entry() {
            Some((_, _, message, _)) => message.map(str::to_owned),
            None => [
                self.to_string(),
                format!(
                    "ARCore ist auf eine Weise ausgefallen, die diese App nicht kennt ({}).",
                    self.0
                ),
            ],
        };
        let [english, german] = self.remedy().words();
        let [told_in_english, told_in_german] = told;
        Translated([
            format!("{told_in_english} {english}"),
            format!("{told_in_german} {german}"),
        ])
    }

    /// The remedy.
    #[must_use]
    pub fn remedy(self) -> Remedy {
        self.entry().map_or(Remedy::Report, |entry| entry.3)
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.entry() {
            Some((number, name, [message, _], _)) => write!(f, "{message} ({name}, {number})"),
            None => write!(
                f,
                "ARCore failed in a way that this app does not know ({}).",
                self.0
            ),
        }
    }
}

impl std::error::Error for Failure {}

/// Availability of ARCore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Availability {
    /// It can be used.
    Installed,
    /// It must be installed, or updated.
    ToInstall,
    /// The check is running: to be repeated.
    Checking,
    /// Unknown, for instance without a network: an installation is offered.
    Unknown,
    /// ARCore does not support this phone.
    NotCapable,
}

/// Meaning of the result of `ArCoreApk_checkAvailability`. Any other number counts as unknown.
#[must_use]
pub fn availability(number: ArAvailability) -> Availability {
    match number {
        1 => Availability::Checking,
        100 => Availability::NotCapable,
        201 | 202 => Availability::ToInstall,
        203 => Availability::Installed,
        _ => Availability::Unknown,
    }
}

/// Tracking state by `ArTrackingFailureReason`, while ARCore does not track the camera.
#[must_use]
pub fn tracking_without_pose(reason: ArTrackingFailureReason) -> Tracking {
    match reason {
        // An internal bad state: ARCore relocalises.
        1 => Tracking::Relocalising,
        2 => Tracking::TooDark,
        3 => Tracking::TooFast,
        4 => Tracking::TooPlain,
        // None, as at the start; 5, the camera is unavailable; and reasons that later versions add.
        _ => Tracking::Starting,
    }
}

/// The app's event for a failure that ends tracking.
#[must_use]
pub fn event_of(failure: Failure) -> ShellEvent {
    match (failure, failure.remedy()) {
        (Failure(PERMISSION_NOT_GRANTED), _) => ShellEvent::Permission(Permission::Denied),
        (Failure(CAMERA_NOT_AVAILABLE), _) => {
            // The app requests it again by itself.
            let words = [
                "Another app uses the camera. Close it to continue here.",
                "Eine andere App benutzt die Kamera. Schließe sie, dann geht es hier weiter.",
            ];
            ShellEvent::ArTrouble(ArSession::Interrupted, words.into())
        }
        (_, Remedy::None | Remedy::UpdateApp) => {
            ShellEvent::ArTrouble(ArSession::Unsupported, failure.words())
        }
        _ => ShellEvent::ArTrouble(ArSession::Failed, failure.words()),
    }
}

//! One table with every text of the interface, in each language.

use std::fmt::Display;

use crate::app::Language;

/// A text in each language, in their order; `{}` stands for an inserted part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words([&'static str; Language::ALL.len()]);

impl Words {
    /// The text in a language.
    pub(super) const fn in_language(self, language: Language) -> &'static str {
        let Self([english, german]) = self;
        match language {
            Language::English => english,
            Language::German => german,
        }
    }

    /// The text with its parts inserted in order.
    pub(super) fn filled(self, language: Language, parts: &[&dyn Display]) -> String {
        // A part may contain braces of its own, such as the name of a file.
        let mut between = self.in_language(language).split("{}");
        let mut text = between.next().unwrap_or_default().to_owned();
        for (part, after) in parts.iter().zip(between) {
            text.push_str(&part.to_string());
            text.push_str(after);
        }
        text
    }
}

/// The whole table, for maintainers and tests.
#[must_use]
pub fn all_words() -> Vec<[&'static str; Language::ALL.len()]> {
    ALL.iter().map(|words| words.0).collect()
}

macro_rules! words {
    ($($name:ident: $english:literal, $german:literal;)*) => {
        $(pub(super) const $name: Words = Words([$english, $german]);)*
        const ALL: &[Words] = &[$($name),*];
    };
}

words! {
    WELCOME: "Bring your toy to life", "Dein Spielzeug wird lebendig";
    WELCOME_HINT: "Point at a table, hold still, put the toy down: it moves, and its own real shadow with it. The picture never leaves this device.", "Tisch zeigen, stillhalten, Spielzeug hinstellen: Es bewegt sich, und sein eigener Schatten mit ihm. Das Bild bleibt auf diesem Gerät.";
    CARD_SEEN: "The card is seen", "Die Karte ist zu sehen";
    CARD_SEEN_HINT: "Take the toy off the table, then tap on the table.", "Nimm das Spielzeug vom Tisch und tippe auf den Tisch.";
    SHOW_TABLE: "Point at the table", "Zeig den Tisch";
    SHOW_TABLE_HINT: "Take the toy off, and move the phone slowly sideways.", "Nimm das Spielzeug weg und bewege das Telefon langsam seitwärts.";
    TABLE_FOUND: "The table is found", "Der Tisch ist gefunden";
    TABLE_FOUND_HINT: "Tap on the table.", "Tippe auf den Tisch.";
    KEEP_STILL: "Hold still", "Stillhalten";
    PLATE_HINT: "The empty place is photographed.", "Der leere Platz wird fotografiert.";
    LENS_HINT: "The lens on the card is photographed.", "Die Linse auf der Karte wird fotografiert.";
    PUT_TOY: "Put the toy down", "Stell das Spielzeug hin";
    PUT_TOY_HINT: "Where you like on the table, then take your hand away.", "Wohin du magst auf dem Tisch, dann nimm die Hand weg.";
    TAP_TOY_HINT: "It is not seen yet. Tap it in the picture.", "Noch ist es nicht zu sehen. Tippe es im Bild an.";
    LOOKING: "One moment", "Einen Moment";
    LOOKING_HINT: "Searching for the toy.", "Das Spielzeug wird gesucht.";
    ASK: "Is it on your toy?", "Liegt es auf dem Spielzeug?";
    ASK_SEARCHING: "It may still get better.", "Es wird vielleicht noch besser.";
    ASK_HINT: "If not, turn it.", "Wenn nicht, dreh es.";
    BY_HAND: "Turn it onto the toy", "Dreh es auf das Spielzeug";
    BY_HAND_HINT: "One thumb around the ring turns it, within the ring it moves.", "Ein Daumen rund um den Ring dreht, im Ring verschiebt er.";
    ALIGN_HINT: "The toy is measured.", "Das Spielzeug wird vermessen.";
    NO_AR_HERE: "This phone has no AR", "Dieses Telefon hat kein AR";
    NO_AR_HINT: "Its system cannot follow the camera, which this app needs.", "Sein System kann der Kamera nicht folgen, was diese App braucht.";
    CAMERA_NEEDED: "The camera is needed", "Die Kamera wird gebraucht";
    CAMERA_NEEDED_HINT: "Without its picture there is nothing to animate. Nothing is sent anywhere.", "Ohne ihr Bild bewegt sich nichts. Nichts wird irgendwohin gesendet.";
    CAMERA_BARRED: "The camera is not allowed", "Die Kamera ist nicht erlaubt";
    CAMERA_BARRED_HINT: "Allow it in the system's settings, then come back.", "Erlaube sie in den Einstellungen und komm zurück.";
    TOO_HOT: "The phone is too hot", "Das Telefon ist zu heiß";
    TOO_HOT_HINT: "Let it cool down. It goes on by itself.", "Lass es abkühlen. Es geht von selbst weiter.";
    INSTALLING_HINT: "This phone's AR services are being checked.", "Was das Telefon für AR braucht, wird gesucht.";
    INTERRUPTED: "The camera is in use elsewhere", "Die Kamera ist anderswo in Gebrauch";
    INTERRUPTED_HINT: "It goes on here when that has ended.", "Hier geht es weiter, wenn das endet.";
    AR_FAILED: "Tracking has stopped", "Das Tracking hat aufgehört";
    AR_FAILED_HINT: "Start over from the table.", "Beginne wieder beim Tisch.";
    PREPARING: "Getting ready", "Es wird vorbereitet";
    PREPARING_HINT: "Graphics are being prepared.", "Die Grafik wird vorbereitet.";
    LOOK_AROUND: "Look around", "Sieh dich um";
    LOOK_AROUND_HINT: "Move the phone slowly over the table.", "Bewege das Telefon langsam über den Tisch.";
    SLOWER: "Slower", "Langsamer";
    SLOWER_HINT: "The phone moves too fast to be followed.", "Das Telefon bewegt sich zu schnell.";
    TOO_PLAIN: "Too little to hold on to", "Zu wenig Muster";
    TOO_PLAIN_HINT: "A patterned cloth or a newspaper beside the toy helps.", "Ein Tuch mit Muster oder eine Zeitung daneben hilft.";
    TOO_DARK: "Too dark", "Zu dunkel";
    TOO_DARK_HINT: "Switch on a lamp.", "Schalte eine Lampe ein.";
    RELOCALISING: "Where is the table?", "Wo ist der Tisch?";
    RELOCALISING_HINT: "Point the phone at the table again.", "Richte das Telefon wieder auf den Tisch.";
    NO_TABLE_THERE: "No table was found there yet. Show more of it, then tap again.", "Dort ist noch kein Tisch gefunden. Zeig mehr davon und tippe noch einmal.";
    TOY_MISSED: "Not quite. Turn it or move it a little.", "Nicht ganz. Dreh oder verschiebe es ein wenig.";
    TOY_CUT_OFF: "Too little of the toy is in the picture. Show all of it, then try again.", "Vom Spielzeug ist zu wenig im Bild. Zeig es ganz und versuche es noch einmal.";
    NO_PLATE: "The empty place could not be photographed. It goes on without that.", "Der leere Platz ließ sich nicht fotografieren. Es geht ohne weiter.";
    PICTURE_FAILED: "This toy cannot be drawn here. Move it, or choose another; log.txt has the reason.", "Dieses Spielzeug lässt sich hier nicht zeichnen. Stell es um oder wähle ein anderes; der Grund steht in log.txt.";
    ONE_LIGHT: "The lens shows one light.", "Die Linse zeigt ein Licht.";
    N_LIGHTS: "The lens shows {} lights.", "Die Linse zeigt {} Lichter.";
    LENS_NOT_DARK: "This camera cannot be darkened for the lens. Lights are found by the shadow.", "Diese Kamera lässt sich für die Linse nicht abdunkeln. Der Schatten zeigt die Lichter.";
    LENS_NO_LIGHT: "The lens shows no light. Lights are found by the shadow.", "Auf der Linse ist kein Licht zu sehen. Der Schatten zeigt die Lichter.";
    LENS_NOT_SEEN: "The lens is not in the picture. Show the whole card.", "Die Linse ist nicht im Bild. Zeig die ganze Karte.";
    CARD_REFUSED: "This phone cannot look for the card. Go on without it.", "Dieses Telefon kann die Karte nicht suchen. Es geht auch ohne.";
    TOY_UNREADABLE: "{} cannot be read. Copy it into the app's folder again.", "{} lässt sich nicht lesen. Kopiere es noch einmal in den Ordner der App.";
    TOY_TOO_LARGE: "{} is larger than {} MiB. Use a smaller model.", "{} ist größer als {} MiB. Nimm ein kleineres Modell.";
    TOY_FOREIGN: "{} is not glTF 2.0. Open the toy's model in Blender and export it as glTF Binary (.glb).", "{} ist kein glTF 2.0. Öffne das Modell in Blender und exportiere es als glTF Binary (.glb).";
    TOY_EXTENSION: "{} requires {}, which this app does not read. Export it without that.", "{} verlangt {}, was diese App nicht liest. Exportiere es ohne das.";
    TOY_TOO_MANY: "{} has too much at {}: {}, and {} is the limit. Use a simpler model.", "{} hat zu viel bei {}: {}, und {} ist die Grenze. Nimm ein einfacheres Modell.";
    TOY_EXTERNAL: "{} needs other files. Export it as one file, glTF Binary (.glb).", "{} braucht weitere Dateien. Exportiere es als eine Datei, glTF Binary (.glb).";
    TOY_EMPTY: "{} has no triangles. Export the toy's mesh with it.", "{} hat keine Dreiecke. Exportiere das Netz des Spielzeugs mit.";
    TOY_PICTURE: "A picture in {} cannot be read. Export it as PNG or JPEG.", "Ein Bild in {} ist nicht lesbar. Exportiere es als PNG oder JPEG.";
    TOY_DAMAGED: "{} is not valid at {}. Export it again; log.txt has the reason.", "{} ist bei {} nicht gültig. Exportiere es neu; der Grund steht in log.txt.";
    WORLD_LOST: "The phone has lost the place. Show the table again.", "Das Telefon hat den Ort verloren. Zeig wieder den Tisch.";
    DEVICE_RESTARTED: "Graphics were set up again.", "Die Grafik wurde neu eingerichtet.";
    RESTARTED: "Something went wrong inside the app, so it started again. Recordings are kept.", "In der App ging etwas schief, also beginnt sie neu. Aufgenommenes bleibt erhalten.";
    SAVED: "Saved.", "Gesichert.";
    VIDEO_TOO_LARGE: "The video is as large as it may be: it was ended and saved.", "Das Video ist so groß wie erlaubt: Es wurde beendet und gesichert.";
    SAVED_NO_ROOM: "Not saved: there is no room left.", "Nicht gesichert: Es ist kein Platz mehr frei.";
    SAVED_NOT_ALLOWED: "Not saved: the system does not allow it.", "Nicht gesichert: Das System erlaubt es nicht.";
    SAVED_NOT_SHARED: "Saved in this app's folder, but it cannot be handed on here.", "Im Ordner der App gesichert, lässt sich hier aber nicht weitergeben.";
    SAVED_FAILED: "Not saved: writing failed.", "Nicht gesichert: Das Schreiben schlug fehl.";
    NOTHING_RECORDED: "Nothing was recorded: no frame came with a place.", "Nichts aufgenommen: Kein Bild kam mit einem Ort.";
    RECORDING_DROPS: "Writing is too slow: the recording lacks some frames.", "Das Schreiben ist zu langsam: Der Aufnahme fehlen Bilder.";
    NO_ROOM_TO_RECORD: "Nothing is recorded: there is too little room left.", "Nichts wird aufgenommen: Es ist zu wenig Platz frei.";
    PHONE_CHECKED: "{} of {} are as they should be. The answers are in log.txt, among this app's files.", "{} von {} sind, wie sie sein sollen. Die Antworten stehen in log.txt bei den Dateien der App.";
    MEMORY_LOW: "Memory is short: video and recording end here, and are saved.", "Der Speicher ist knapp: Video und Aufnahme enden hier und werden gesichert.";
    FAILED_LAUNCHES: "The app ended unexpectedly, so it uses a simple shadow. The full one is in the menu.", "Die App endete unerwartet, daher ein einfacher Schatten. Der volle ist im Menü.";
    SELF_TEST_FAILED: "This phone's graphics fail a test, so the shadow is a simple one. The full one is in the menu.", "Die Grafik dieses Telefons besteht einen Test nicht, daher ein einfacher Schatten. Der volle ist im Menü.";
    DRIVER_FAULT: "This app cannot run here: this phone's graphics driver has a known fault.", "Diese App läuft hier nicht: Der Grafiktreiber dieses Telefons hat einen bekannten Fehler.";
    NO_VULKAN: "This app cannot run here: it needs graphics with Vulkan 1.1.", "Diese App läuft hier nicht: Sie braucht Grafik mit Vulkan 1.1.";
    GRAPHICS_FAILED: "The app was closed: this phone's graphics failed.", "Die App wurde geschlossen: Die Grafik dieses Telefons fiel aus.";
    CLOSED: "The app was closed: something went wrong again and again.", "Die App wurde geschlossen: Immer wieder ging etwas schief.";
    STOPPED: "The app has stopped: something went wrong again and again. Touch the screen to begin anew.", "Die App steht still: Immer wieder ging etwas schief. Tippe auf den Bildschirm, um neu zu beginnen.";
    RECORDED: "{}{} frames are recorded{}: {}", "{}{} Bilder sind aufgenommen{}: {}";
    RECORDED_ONE: "{}One frame is recorded{}: {}", "{}Ein Bild ist aufgenommen{}: {}";
    RECORDING_DIED: "Recording ended unexpectedly. Except for the last second, everything is in {}", "Die Aufnahme brach ab. Bis auf die letzte Sekunde ist alles in {}";
    RECORDED_LACKS: ", {} are missing", ", fehlend: {}";
    ENDED_NO_ROOM: "There is no room left. ", "Es ist kein Platz mehr frei. ";
    ENDED_TOO_LARGE: "It is as large as it may be. ", "Sie ist so groß wie erlaubt. ";
    ENDED_NOT_ALLOWED: "The system does not allow it. ", "Das System erlaubt es nicht. ";
    ENDED_FAILED: "It cannot be written. ", "Sie lässt sich nicht schreiben. ";
    GUESSED: "The shadow is a guess: no light was found, since {}.", "Der Schatten ist geschätzt, denn kein Licht wurde gefunden: {}.";
    POSE_UNKNOWN: "the toy's pose is not known well enough", "die Lage des Spielzeugs ist zu ungenau";
    RECEIVERS_UNSEEN: "too little of the table is visible beside the toy", "vom Tisch ist neben dem Spielzeug zu wenig zu sehen";
    NO_LIGHT_STANDS_OUT: "no light stands out, or too little of its shadow is visible", "kein Licht sticht hervor, oder von seinem Schatten ist zu wenig zu sehen";
    FITTED: "Fitted to {} pixels", "Auf {} Pixel genau";
    LITTLE_SEEN: "Too little of the toy is visible to check its place.", "Vom Spielzeug ist zu wenig zu sehen, um es zu prüfen.";
    TOY_LOST: "Looking for the toy ({} pixels off)", "Das Spielzeug wird gesucht ({} Pixel daneben)";
    NOT_FITTED: "It could not be fitted. Move the toy, or choose another.", "Es ließ sich nicht einpassen. Stell es um oder wähle ein anderes.";
    ASK_AXES: "Does green point up, do red and blue lie on the table, and do all stay in their place as you walk around them?", "Zeigt Grün nach oben, liegen Rot und Blau auf dem Tisch, und bleiben alle am Platz, wenn du herumgehst?";
    ASK_TURNED: "Turn the phone like a steering wheel, to the right and to the left. Do the arrows stay with the table?", "Dreh das Telefon wie ein Lenkrad nach rechts und links. Bleiben die Pfeile am Tisch?";
    ASK_SQUARE: "Look at the printed card. Does the white line lie on the edge of its pattern, in the middle of the picture and in each corner?", "Sieh auf die gedruckte Karte. Liegt die weiße Linie auf dem Rand des Musters, in der Bildmitte und in jeder Ecke?";
    ASK_GREYS: "Hold white paper and something black beside the patches. Is the paper nearly as white, the other nearly as black, and neither tinted?", "Halte weißes Papier und etwas Schwarzes neben die Felder. Ist das eine fast so weiß, das andere fast so schwarz, und beides ohne Farbe?";
    ASK_COLOURS: "Hold something red, something green and something blue there. Do they look as in the phone's own camera app?", "Halte etwas Rotes, Grünes und Blaues dorthin. Sieht es aus wie in der Kamera-App des Telefons?";
    ASK_UPRIGHT: "Is the picture upright, can letters be read, and is a cup seen from above as round as the circle?", "Steht das Bild aufrecht, ist Schrift lesbar, und ist eine Tasse von oben so rund wie der Kreis?";
    ASK_RULER: "Lay a ruler along the line. Is it 10 cm long, to a millimetre?", "Leg ein Lineal an die Linie. Ist sie auf den Millimeter 10 cm lang?";
    ASK_DELAY: "Hold the phone before a mirror. In the mirror, is the same cell lit, or the one below it?", "Halte das Telefon vor einen Spiegel. Leuchtet im Spiegel dasselbe Feld oder das darunter?";
    ASK_HELD: "Hold a white sheet into the picture, and take it away. Is the table as bright all the time?", "Halte ein weißes Blatt ins Bild und nimm es weg. Bleibt der Tisch immer gleich hell?";
    ASK_RETURN: "Lock the phone, or take a call, and come back. Is the picture there again, or a word on what to do?", "Sperre das Telefon oder nimm einen Anruf an und komm zurück. Ist das Bild wieder da, oder ein Hinweis, was zu tun ist?";
    N_OF: "{} of {}", "{} von {}";
    CHECK: "Check this phone", "Telefon prüfen";
    YES: "Yes", "Ja";
    NO: "No", "Nein";
    STOP: "Stop", "Abbrechen";
    ALLOW_CAMERA: "Allow the camera", "Kamera erlauben";
    BEGIN: "Begin", "Anfangen";
    TRY_AGAIN: "Try again", "Noch einmal";
    LEAVE: "To the first screen", "Zum Anfang";
    USE_CARD: "I have the card", "Ich habe die Karte";
    NO_CARD: "I have no card", "Ich habe keine Karte";
    NO_AR: "AR cannot begin", "AR kann nicht beginnen";
    OPEN_SETTINGS: "Open settings", "Einstellungen";
    HERE: "Here", "Hier";
    SKIP_PLATE: "The toy stays there", "Das Spielzeug bleibt stehen";
    PLACED: "It fits", "Es passt";
    TURN: "Turn it", "Drehen";
    LOOK_AGAIN: "Find it for me", "Such es für mich";
    TAKE_LENS: "Light from the lens", "Licht von der Linse";
    BACK: "Back", "Zurück";
    START_OVER: "Start over", "Von vorn";
    PLAY: "Play", "Abspielen";
    PAUSE: "Pause", "Pause";
    TIME: "Time in the clip", "Zeit im Clip";
    AUTHORED: "Standing", "Stehend";
    PHOTO: "Photo", "Foto";
    VIDEO: "Video", "Video";
    END_VIDEO: "End video", "Video beenden";
    MORE: "More", "Mehr";
    LESS: "Close", "Schließen";
    TOY_GROUP: "Toy", "Spielzeug";
    ENGINEER_GROUP: "For engineers", "Für Techniker";
    RECORD: "Record the session", "Sitzung aufnehmen";
    END_RECORD: "End the recording", "Aufnahme beenden";
    RECORDING: "Recording", "Aufnahme läuft";
    PROFILE: "Show times", "Zeiten zeigen";
    REPLACE: "Move the toy", "Spielzeug umstellen";
    RETAKE: "Photograph the empty place", "Platz fotografieren";
    PICK_TOY: "Another toy", "Anderes Spielzeug";
    WHERE_TOYS_ARE: "Put toys of your own, as binary glTF files (.glb), into this app's folder, and they are listed here.", "Lege eigenes Spielzeug als binäre glTF-Dateien (.glb) in den Ordner der App, dann steht es hier.";
    SIMPLE: "Simple shadow", "Einfacher Schatten";
    RESTORE: "Full shadow", "Voller Schatten";
    SHARE: "Share log and recording", "Log und Aufnahme teilen";
    PLATE_GROWING: "Good. Keep still.", "Gut. Stillhalten.";
    PLATE_DONE: "Done.", "Fertig.";
    PLATE_WAITING: "Waiting for the camera.", "Warten auf die Kamera.";
    PLATE_MOVING: "Keep the phone still, or lean it on something.", "Halte das Telefon still oder lehne es an.";
    PLATE_BLURRED: "The picture is not sharp yet.", "Das Bild ist noch nicht scharf.";
    PLATE_OBSTRUCTED: "Something moves in the picture. Take your hand away.", "Im Bild bewegt sich etwas. Nimm die Hand weg.";
    PLATE_EXPOSURE: "The camera is still adapting to the light.", "Die Kamera gewöhnt sich noch an das Licht.";
}

//! Comparison of names, signatures and numbers with ARCore's own header, which is not part of the
//! project.

use std::env;
use std::fs;

use super::ffi::SIGNATURES;
use super::status::STATUSES;

/// The Rust form, as in the table, of a type of C.
fn in_rust(c: &str) -> String {
    let n_stars = c.matches('*').count();
    let is_const = c.contains("const ");
    let name = c.replace("const ", "").replace('*', "");
    let name = match name.trim() {
        "int32_t" => "i32",
        "int64_t" => "i64",
        "uint32_t" => "u32",
        "uint8_t" => "u8",
        "float" => "f32",
        "char" => "c_char",
        "void" => "c_void",
        name => name,
    };
    // A `const` applies to the target of the innermost pointer.
    let inner = match (n_stars, is_const) {
        (0, _) => String::new(),
        (_, true) => "*const ".to_owned(),
        (_, false) => "*mut ".to_owned(),
    };
    format!("{}{inner}{name}", "*mut ".repeat(n_stars.saturating_sub(1)))
}

/// Type of a parameter, without its name.
fn parameter(c: &str) -> String {
    let c = c.trim();
    let end = c.rfind(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
    in_rust(&c[..end.map_or(0, |end| end + 1)])
}

/// A function's prototype without comments: its return type, and its arguments.
fn prototype(header: &str, name: &str) -> Option<(String, Vec<String>)> {
    let at = header.find(&format!(" {name}("))?;
    let returns = header[..at].rsplit(['\n', ';', '}']).next()?.trim();
    let inside = header[at..].split_once('(')?.1.split_once(')')?.0;
    let returns = if returns == "void" {
        String::new()
    } else {
        in_rust(returns)
    };
    Some((returns, inside.split(',').map(parameter).collect()))
}

fn without_comments(header: &str) -> String {
    let lines = header
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Entries of the table, and of the table of statuses, that a header does not contain.
fn differences(header: &str) -> Vec<String> {
    let header = without_comments(header);
    let mut differences = Vec::new();
    for signature in SIGNATURES {
        let ours = (
            signature.returns.to_owned(),
            signature
                .arguments
                .iter()
                .map(|of| (*of).to_owned())
                .collect::<Vec<_>>(),
        );
        let theirs = prototype(&header, signature.name);
        if theirs.as_ref() != Some(&ours) {
            differences.push(format!("{}: {ours:?}, the header has {theirs:?}", signature.name));
        }
    }
    let statuses = header
        .split_once("AR_DEFINE_ENUM(ArStatus){")
        .and_then(|(_, rest)| rest.split_once('}'));
    let listed = statuses.map_or("", |(listed, _)| listed);
    let mut theirs: Vec<String> = listed.split(',').map(|entry| entry.trim().to_owned()).collect();
    theirs.retain(|entry| !entry.is_empty() && entry != "AR_SUCCESS = 0");
    let ours: Vec<String> = STATUSES
        .iter()
        .map(|(number, name, _, _)| format!("{name} = {number}"))
        .collect();
    if theirs != ours {
        differences.push(format!("statuses: {ours:?}, the header has {theirs:?}"));
    }
    differences
}

#[test]
#[ignore = "needs ARCORE_HEADER, the path of arcore_c_api.h"]
fn the_table_is_that_of_the_header() {
    let path = env::var_os("ARCORE_HEADER").expect("ARCORE_HEADER");
    let header = fs::read_to_string(path).expect("a header");
    let differences = differences(&header);
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn a_header_that_says_something_else_is_noticed() {
    let header = "AR_DEFINE_ENUM(ArStatus){ /* all */ AR_SUCCESS = 0};\n\
                  ArStatus ArSession_pause(ArSession *session); // paused\n\
                  void ArSession_destroy(const ArSession *session);\n\
                  void ArImage_getPlaneData(const ArSession *session,\n const ArImage *image, int32_t plane_index,\n\
                  const uint8_t **out_data, int32_t *out_data_length);\n";
    let differences = differences(header).join("\n");
    for same in ["ArSession_pause:", "ArImage_getPlaneData:"] {
        assert!(!differences.contains(same), "{differences}");
    }
    for other in ["ArSession_destroy:", "ArSession_resume:", "statuses:"] {
        assert!(differences.contains(other), "{other}");
    }
}

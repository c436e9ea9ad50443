//! Which build of the program this is.

use std::fs;
use std::time::SystemTime;

/// What tells one build of the program from another: version, size and time of its file; `None` where these cannot be had. So whoever changes the bake never
/// meets a scene of the old one.
pub(super) fn program() -> Option<Vec<u8>> {
    let file = std::env::current_exe().and_then(fs::metadata).ok()?;
    let built = file.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some(format!("{} {} {built:?}", env!("CARGO_PKG_VERSION"), file.len()).into_bytes())
}

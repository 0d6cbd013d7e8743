//! Files are read up to their limit and written whole or not at all.

use files::{LockError, ReadError};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An empty folder of that name.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder can be made");
    path
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect()
}

#[test]
fn a_file_is_read_up_to_its_limit() {
    let path = folder("limit").join("file");
    fs::write(&path, b"12345").expect("a file can be written");
    assert_eq!(files::read(&path, 5).expect("short enough"), b"12345");
    assert!(matches!(files::read(&path, 4), Err(ReadError::TooLarge { bytes: 5, limit: 4 })));
    assert!(matches!(files::read(path.parent().expect("a folder"), 5), Err(ReadError::NotAFile)));
    assert!(matches!(files::read(&path.with_file_name("none"), 5), Err(ReadError::Io(_))));
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_not_read() {
    let pipe = folder("pipe").join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    for path in [Path::new("/dev/zero"), &pipe] {
        assert!(matches!(files::read(path, 5), Err(ReadError::NotAFile)), "{path:?}");
    }
}

#[test]
fn a_write_that_fails_leaves_the_old_file_and_nothing_else() {
    let folder = folder("fails");
    let path = folder.join("file");
    files::write_bytes(&path, b"old").expect("a folder to write to");
    let failed = files::write(&path, |writer| {
        writer.write_all(&[0; 100_000])?;
        Err(io::Error::other("no more"))
    });
    assert!(failed.is_err());
    assert_eq!((fs::read(&path).expect("still there"), names(&folder)), (b"old".to_vec(), vec!["file".to_owned()]));
    files::write_bytes(&path, b"new").expect("a folder to write to");
    assert_eq!((fs::read(&path).expect("there"), names(&folder)), (b"new".to_vec(), vec!["file".to_owned()]));
}

#[cfg(unix)]
#[test]
fn a_full_device_is_an_error_whatever_is_written() {
    // So few bytes stay in a buffer until it is flushed.
    for count in [1, 100_000] {
        let error = files::write_bytes(Path::new("/dev/full"), &vec![0; count]).expect_err("it is full");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}

#[cfg(unix)]
#[test]
fn links_permissions_and_protection_of_the_old_file_are_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder("old");
    let (path, link) = (folder.join("file"), folder.join("link"));
    fs::write(&path, b"old").expect("a file can be written");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("our own file");
    symlink("file", &link).expect("a link can be made");
    files::write_bytes(&link, b"new").expect("a folder to write to");
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert_eq!(fs::read(&path).expect("there"), b"new");
    assert_eq!(fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o640);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o440)).expect("our own file");
    assert_eq!(files::write_bytes(&path, b"newer").expect_err("protected").kind(), io::ErrorKind::PermissionDenied);
    assert_eq!(fs::read(&path).expect("there"), b"new");
    assert!(files::write_bytes(&folder, b"a folder").is_err());
}

#[test]
fn writers_at_once_do_not_mix() {
    let path = folder("at-once").join("file");
    let whole: Vec<Vec<u8>> = (0..8u8).map(|k| vec![k; 50_000]).collect();
    std::thread::scope(|scope| {
        for bytes in &whole {
            scope.spawn(|| (0..20).for_each(|_| files::write_bytes(&path, bytes).expect("a folder to write to")));
        }
    });
    assert!(whole.contains(&fs::read(&path).expect("there")));
    assert_eq!(names(path.parent().expect("a folder")), ["file"]);
}

#[test]
fn a_folder_is_locked_once() {
    let folder = folder("lock").join("made");
    let first = files::lock(&folder).expect("nobody else");
    assert!(matches!(files::lock(&folder), Err(LockError::Taken)));
    drop(first);
    files::lock(&folder).expect("free again");
}

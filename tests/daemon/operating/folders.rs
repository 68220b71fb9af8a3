//! Where daemon and client look for each other, and whose folders these are.

use std::{fs, os::unix::fs::symlink, path::PathBuf};

use untangled_testkit::process::{Daemon, TestDomain, serve};

use untangled_testkit::process::untangled;

/// A folder for this test, removed with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("ut-{}-{name}", std::process::id()));
        fs::create_dir(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn status(domain: &TestDomain, runtime: &str) -> String {
    let mut command = std::process::Command::new(untangled());
    command.args(["status", "--domain", domain.name()]).env("XDG_RUNTIME_DIR", runtime);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

/// The daemon is below /tmp, as a service without the variable is; the client has the variable.
#[test]
fn client_with_another_runtime_folder_is_told_where_its_daemon_serves() {
    let domain = TestDomain::new();
    let folder = Folder::new("run");
    let mut command = serve(&domain);
    command.env_remove("XDG_RUNTIME_DIR");
    let daemon = Daemon::start_as(command);
    let words = status(&domain, folder.0.to_str().unwrap());
    assert!(words.contains(&format!("below {}/untangled", folder.0.display())), "{words}");
    assert!(words.contains("one does below /tmp/untangled-") && words.contains("unset XDG_RUNTIME_DIR"), "{words}");
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 0, "a client makes no folder");
    drop(daemon);
}

#[test]
fn relative_runtime_folder_is_refused() {
    let domain = TestDomain::new();
    let words = status(&domain, "run");
    assert!(words.contains("XDG_RUNTIME_DIR is `run`; it must be an absolute path"), "{words}");
}

#[test]
fn daemon_below_a_folder_of_another_user_does_not_start_and_changes_no_file() {
    if !rustix::process::getuid().is_root() {
        println!("skipped: only root can make a folder of another user");
        return;
    }
    let domain = TestDomain::new();
    let folder = Folder::new("own");
    let (base, victim) = (folder.0.join("untangled"), folder.0.join("victim"));
    fs::write(&victim, "precious\n").unwrap();
    fs::create_dir(&base).unwrap();
    symlink(&victim, base.join(format!("{}.lock", domain.name()))).unwrap();
    std::os::unix::fs::chown(&base, Some(65534), Some(65534)).unwrap();
    let output = serve(&domain).env("XDG_RUNTIME_DIR", &folder.0).output().unwrap();
    let words = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{words}");
    assert!(words.contains("belongs to user 65534"), "{words}");
    assert_eq!(fs::read_to_string(&victim).unwrap(), "precious\n");
}

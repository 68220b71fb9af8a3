//! Certificates of an authority of one's own.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::network;

/// Daemon ends in namespaces for which certificates hold as well.
const NUM_NAMESPACES: usize = 4;

/// An authority and certificates of it, made by `openssl`; nothing where it is not there.
#[derive(Debug)]
pub struct Authority(PathBuf);

impl Authority {
    /// A new one of this name; says on standard error where it can't be made.
    #[must_use]
    pub fn new(name: &str) -> Option<Self> {
        let folder = std::env::temp_dir().join(format!("bridge-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let key = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2"];
        let made = Command::new("openssl")
            .args(key)
            .args(["-subj", &format!("/CN={name}"), "-keyout", "ca.key", "-out", "ca.pem"])
            .current_dir(&folder)
            .output();
        if made.is_ok_and(|output| output.status.success()) {
            return Some(Self(folder));
        }
        eprintln!("SKIPPED: certificates: there is no openssl on this machine");
        None
    }

    /// A configuration of these keys and tables, with a certificate of this name, that trusts an authority.
    #[must_use]
    pub fn config(&self, name: &str, keys: &str, tables: &str, trusts: &Path) -> PathBuf {
        let [key, request, certificate, names] = ["key", "csr", "pem", "ext"].map(|end| format!("{name}.{end}"));
        let addresses: String = (0..NUM_NAMESPACES).map(|k| format!(",IP:{}", network::daemon_ip(k))).collect();
        let alternatives = format!("subjectAltName=IP:127.0.0.1,DNS:localhost{addresses}");
        fs::write(self.0.join(&names), format!("{alternatives}\nextendedKeyUsage=serverAuth,clientAuth\n")).unwrap();
        let new = "req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes";
        self.openssl(&format!("{new} -subj /CN={name} -keyout {key} -out {request}"));
        let by = "-CA ca.pem -CAkey ca.key -CAcreateserial -days 2";
        self.openssl(&format!("x509 -req -in {request} {by} -extfile {names} -out {certificate}"));
        let [certificate, key] = [certificate, key].map(|file| self.0.join(file));
        let tls = [("authority", trusts), ("certificate", &certificate), ("key", &key)];
        let tls: Vec<String> = tls.iter().map(|(key, path)| format!("{key} = '{}'", path.display())).collect();
        self.write(name, &format!("{keys}\nname = '{name}'\n[tls]\n{}\n{tables}\n", tls.join("\n")))
    }

    /// A configuration beside the certificates, as it stands.
    #[must_use]
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(format!("{name}.toml"));
        fs::write(&path, text).unwrap();
        path
    }

    fn openssl(&self, arguments: &str) {
        let output = Command::new("openssl").args(arguments.split(' ')).current_dir(&self.0).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    /// Its own certificate.
    #[must_use]
    pub fn certificate(&self) -> PathBuf {
        self.0.join("ca.pem")
    }
}

impl Drop for Authority {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

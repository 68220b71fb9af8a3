use untangle::settings::Settings;

use super::{Config, ConfigError, Telemetry};

#[test]
fn explained_of_any_config_explains_every_key_and_reads_back() {
    let config = Config {
        settings: Settings {
            thickness_m: Some(0.002),
            max_face_pairs: Some(1),
            max_tested_pairs: Some(1),
            deadline_us: Some(1),
            ..Settings::default()
        },
        ..Config::default()
    };
    let text = config.explained().unwrap();
    assert_eq!(toml::from_str::<Config>(&text).unwrap(), config);
    let lines: Vec<&str> = text.lines().collect();
    for (k, line) in lines.iter().enumerate() {
        if line.contains(" = ") && !line.starts_with('#') {
            assert!(lines[k - 1].starts_with("# "), "{line} has no explanation");
        }
    }
    let text = Config::default().explained().unwrap();
    assert!(
        ["thickness_m", "max_face_pairs", "max_tested_pairs", "deadline_us"]
            .iter()
            .all(|key| { text.contains(&format!("\n# {key} = ")) })
    );
    assert_eq!(toml::from_str::<Config>(&text).unwrap(), Config::default());
}

#[test]
fn metrics_of_another_than_a_loopback_address_is_an_error() {
    let metrics = |value: &str| {
        let telemetry = Telemetry { metrics: value.to_owned(), ..Telemetry::default() };
        Config { telemetry, ..Config::default() }.metrics()
    };
    assert!(metrics("").unwrap().is_none());
    assert!(metrics("127.0.0.1:9464").unwrap().is_some() && metrics("[::1]:0").unwrap().is_some());
    for bad in ["0.0.0.0:9464", "192.168.0.1:80", "localhost", "9464"] {
        assert!(matches!(metrics(bad), Err(ConfigError::Metrics { .. })), "{bad}");
    }
}

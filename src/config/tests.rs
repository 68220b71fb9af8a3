use untangle::settings::{Quality, Settings};

use super::{Config, ConfigError, ConfigFlags, Telemetry};

#[test]
fn explained_of_any_config_explains_every_key_and_reads_back() {
    let config = Config {
        settings: Settings {
            thickness_m: Some(0.002),
            max_face_pairs: Some(1),
            max_tested_pairs: Some(1),
            deadline_us: Some(1),
            repair_deadline_us: Some(1),
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
        ["thickness_m", "max_face_pairs", "max_tested_pairs", "deadline_us", "repair_deadline_us"]
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

fn load(variables: &[(&str, &str)], file: Option<&str>) -> Result<(Config, Vec<String>), ConfigError> {
    let path = std::env::temp_dir().join(format!("config-{}-{:p}.toml", std::process::id(), &variables));
    let config = file.map(|text| {
        std::fs::write(&path, text).unwrap();
        path.clone()
    });
    let flags = ConfigFlags { config, quality: Some("fast".to_owned()), ..ConfigFlags::default() };
    let loaded = Config::load_with(&flags, variables.iter().map(|(name, value)| (name.into(), value.into())));
    let _ = std::fs::remove_file(path);
    loaded
}

#[test]
fn load_takes_later_layers_over_earlier_ones_and_values_over_their_quality() {
    let file = "num_workers = 3\n[settings]\npath_rings = 4\nmax_centres = 77\nmax_step_edge_lengths = inf\n";
    let variables = [("UNTANGLED_SETTINGS__PATH_RINGS", "5"), ("UNTANGLED_DOMAIN", ""), ("PATH", "/bin")];
    let (config, warnings) = load(&variables, Some(file)).unwrap();
    let mut expected = Config { num_workers: 3, quality: Quality::Fast, ..Config::default() };
    Quality::Fast.apply(&mut expected.settings);
    expected.settings.path_rings = 5;
    expected.settings.max_centres = 77;
    expected.settings.max_step_edge_lengths = f64::INFINITY;
    assert_eq!((config, warnings), (expected, vec![]));
    let (config, _) = load(&[("UNTANGLED_DOMAIN", "123"), ("UNTANGLED_SETTINGS__WINDING", "true")], None).unwrap();
    assert_eq!((config.domain.as_str(), config.settings.winding), ("123", true));
}

#[test]
fn load_names_the_place_of_a_wrong_value_and_no_type_of_ours() {
    for (variables, file, words) in [
        (&[("UNTANGLED_NUM_WORKERS", "many")][..], None, "UNTANGLED_NUM_WORKERS: num_workers: "),
        (&[("UNTANGLED_SETTINGS__RESPONSE", "fast")], None, "UNTANGLED_SETTINGS__RESPONSE: settings.response: "),
        (&[], Some("domain = \"a\"\n[settings]\npath_rings = \"x\"\n"), ".toml:3: "),
        (&[], Some("domain = \"a\"\n[settings]\npath_ring = 3\n"), ".toml:3: "),
        (&[], Some("domain = \n"), ".toml:1: "),
    ] {
        let error = load(variables, file).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
        for internal in ["usize", "u32", "src/", "Map<"] {
            assert!(!error.contains(internal), "{error}");
        }
    }
}

#[test]
fn load_warns_of_unknown_variables_with_the_nearest_key() {
    let (_, warnings) = load(&[("UNTANGLED_TELEMETRY__FORMATS", "json"), ("UNTANGLED_HOME", "x")], None).unwrap();
    assert_eq!(warnings.len(), 2);
    assert!(
        warnings[1].contains("UNTANGLED_TELEMETRY__FORMATS") && warnings[1].contains("did you mean"),
        "{warnings:?}"
    );
    assert!(warnings[0].contains("UNTANGLED_HOME") && warnings[0].contains("untangled config"), "{warnings:?}");
}

//! `untangled-bridge status`: asks a running end over HTTP.

use std::{
    io::{Read, Write},
    net::{SocketAddr, TcpStream},
    time::Duration,
};

use clap::Args;
use serde_json::Value;

use crate::error::BridgeError;

const PATIENCE: Duration = Duration::from_secs(2);

#[derive(Debug, Args)]
pub(super) struct StatusArgs {
    /// The address that the end serves metrics on.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:9465")]
    metrics: SocketAddr,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &StatusArgs) -> Result<(), BridgeError> {
    let failed = |source| BridgeError::System { what: format!("asking {}", args.metrics), source };
    let mut stream = TcpStream::connect_timeout(&args.metrics, PATIENCE).map_err(failed)?;
    stream.set_read_timeout(Some(PATIENCE)).map_err(failed)?;
    stream.write_all(b"GET /status HTTP/1.1\r\nHost: localhost\r\n\r\n").map_err(failed)?;
    let mut reply = String::new();
    stream.read_to_string(&mut reply).map_err(failed)?;
    let body = reply.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    let report: Value = serde_json::from_str(body)
        .map_err(|_| BridgeError::Config(format!("{} is no address of an end of a bridge", args.metrics)))?;
    let text = if args.json { format!("{report:#}\n") } else { table(&report) };
    // A reader may leave before the end.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}

/// The report for people.
fn table(report: &Value) -> String {
    let text = |value: &Value| value.as_str().unwrap_or("?").to_owned();
    let ms =
        |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), |seconds| format!("{:.2} ms", 1e3 * seconds));
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    let mut out = format!(
        "untangled-bridge {} {} `{}` on domain `{}`, process {}, up {:.0} s\n",
        text(&report["library_version"]),
        text(&report["end"]),
        text(&report["name"]),
        text(&report["domain"]),
        report["pid"],
        number(&report["uptime_s"]),
    );
    out += &format!(
        "sent {} frames, {:.1} MB; received {}, {:.1} MB; {} overtaken, {} sent again, {} rejected\n",
        report["num_sent"],
        number(&report["bytes_sent"]) / 1e6,
        report["num_received"],
        number(&report["bytes_received"]) / 1e6,
        report["num_overtaken"],
        report["num_sent_again"],
        report["num_rejected"],
    );
    let trip = &report["round_trip"];
    out += &format!("round trip: half within {}, 99 of 100 within {}\n", ms(&trip["p50_s"]), ms(&trip["p99_s"]));
    for daemon in report["daemons"].as_array().into_iter().flatten() {
        let serves = if daemon["serves"] == true { "serves" } else { "has no daemon" };
        out += &format!(
            "daemon `{}` {serves}, {} triangles, {} workers, untangled {}\n",
            text(&daemon["name"]),
            daemon["num_faces"],
            daemon["num_workers"],
            text(&daemon["library_version"]),
        );
    }
    for session in report["sessions"].as_array().into_iter().flatten() {
        out += &format!(
            "session {} at `{}`, {} triangles, {} frames\n",
            session["session"],
            text(&session["daemon"]),
            session["num_faces"],
            session["num_frames"],
        );
    }
    for host in report["hosts"].as_array().into_iter().flatten() {
        out += &format!("host `{}`, {} sessions\n", text(&host["name"]), host["num_sessions"]);
    }
    out
}

#!/usr/bin/env bash
# Looks like `untangled serve --domain NAME ...`, but is a bridge to a daemon in another domain. The process that the
# caller knows becomes the end near the host; daemon and daemon end follow it when it ends in any way.
set -euo pipefail
shift # serve
arguments=()
domain=default
while [[ $# -gt 0 ]]; do
    if [[ $1 == --domain ]]; then
        domain=$2
        shift 2
    else
        arguments+=("$1")
        shift
    fi
done
port=$((20000 + ($$ * 7 + RANDOM) % 10000))
"$SERVE_PROGRAM" serve --domain "$domain-f" "${arguments[@]}" > /dev/null 2>&1 &
daemon=$!
"$BRIDGE_PROGRAM" daemon --domain "$domain-f" --name "far-$$" --listen "127.0.0.1:$port" > /dev/null 2>&1 &
end=$!
own=$$
(
    while kill -0 "$own" 2> /dev/null; do sleep 0.1; done
    kill "$end" "$daemon" 2> /dev/null
) < /dev/null > /dev/null 2>&1 &
exec "$BRIDGE_PROGRAM" host --domain "$domain" --name "near-$$" --connect "127.0.0.1:$port" --log warn

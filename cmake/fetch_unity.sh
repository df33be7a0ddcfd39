#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# fetch_unity.sh FOLDER [cmock|cjson]...: puts the Unity test framework into FOLDER unless it is there already.
#
# Unity has no Debian package of its own, but two packages carry it; they are tried in the order given (default:
# cmock, cjson). Each is one file of the Debian archive, taken from the mirror that this machine's apt is set up
# with and accepted only if its SHA-256 is the one below. apt's own state and configuration are not touched, and
# no rights are needed.
set -euo pipefail

readonly cmock_what="the package cmock of Debian trixie"
readonly cmock_path=pool/main/c/cmock/cmock_2.5.3+git40-g379a9a8-2_all.deb
readonly cmock_sha256=166e45090937251892363d10860b5e7aa5353d5553fde2cbaba514760ba3785e

readonly cjson_what="the source package cjson of Debian bookworm"
readonly cjson_path=pool/main/c/cjson/cjson_1.7.15.orig.tar.gz
readonly cjson_sha256=5308fd4bd90cef7aa060558514de6a1a4a0819974a26e6ed13973c5f624c24b2

readonly apt_helper=/usr/lib/apt/apt-helper

# The archives apt knows, one a line; Debian's main archive is the first of them on an ordinary machine.
list_archives() {
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 2>/dev/null | awk '!seen[$0]++'
}

# download PATH SHA256 FILE: takes PATH from the first archive that has it with this hash.
download() {
    local archive
    while read -r archive; do
        # As root, apt would hand the download to a user who may not write here.
        if "$apt_helper" -o APT::Sandbox::User=root -o Acquire::Retries=3 \
            download-file "${archive%/}/$1" "$3" "SHA256:$2" >"$work/log" 2>&1 &&
            printf '%s  %s\n' "$2" "$3" | sha256sum --check --status; then
            return 0
        fi
        rm -f "$3"
    done < <(list_archives)
    return 1
}

# fetch_NAME OUT: leaves unity.c, unity.h, unity_internals.h and the licence in OUT.
fetch_cmock() {
    download "$cmock_path" "$cmock_sha256" "$work/cmock.deb" || return 1
    dpkg-deb -x "$work/cmock.deb" "$work/cmock" || return 1
    cp "$work"/cmock/usr/share/cmock/vendor/unity/src/unity*.[ch] "$1" || return 1
    cp "$work/cmock/usr/share/doc/cmock/copyright" "$1/LICENSE.txt"
}

fetch_cjson() {
    download "$cjson_path" "$cjson_sha256" "$work/cjson.tar.gz" || return 1
    mkdir "$work/cjson" && tar -xf "$work/cjson.tar.gz" -C "$work/cjson" --strip-components=1 || return 1
    cp "$work"/cjson/tests/unity/src/unity*.[ch] "$1" || return 1
    # This copy names a settings file of its own; the settings here are those of cmake/unity.cmake.
    sed -i '/#include ".*unity_config.h"/d' "$1/unity_internals.h" || return 1
    cp "$work/cjson/tests/unity/docs/license.txt" "$1/LICENSE.txt"
}

if [ $# -eq 0 ]; then
    echo "fetch_unity.sh: FOLDER is missing; usage: fetch_unity.sh FOLDER [cmock|cjson]..." >&2
    exit 2
fi
folder=$1
shift
[ $# -gt 0 ] || set -- cmock cjson
for name; do
    case $name in
    cmock | cjson) ;;
    *)
        echo "fetch_unity.sh: '$name' is no source of Unity; use cmock or cjson" >&2
        exit 2
        ;;
    esac
done

mkdir -p "$(dirname "$folder")"
# Two presets may be configured at the same time.
exec 9>"$folder.lock"
flock 9
[ ! -s "$folder/unity.c" ] || exit 0

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tried=
for name; do
    what=${name}_what
    tried="${tried:+$tried, nor from }${!what}"
    rm -rf "$folder.new"
    mkdir "$folder.new"
    if "fetch_$name" "$folder.new"; then
        rm -rf "$folder"
        mv "$folder.new" "$folder"
        echo "Unity comes from ${!what}"
        exit 0
    fi
done
rm -rf "$folder.new"
echo "Unity could not be taken from $tried; give a folder with unity.c and unity.h: cmake --preset host -DUNITY_SOURCE_DIR=FOLDER" >&2
exit 1

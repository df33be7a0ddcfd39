// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A store (elmopp/store.h) in files of a folder: two of them, NAME.0 and NAME.1, each a sector with one slot.
///
/// The medium is a copy of both in memory, in which words are programmed and sectors erased as in flash. Only the mark
/// of a slot reaches the disk, and with it the whole sector, into the file that is not in force: written, to the disk
/// (fsync), then its mark, and then the folder. A file that is cut has another length or another checksum and is none;
/// the one in force is not touched meanwhile, so that no draft and no renaming is needed. If only the last step fails,
/// it is told as a failure and may yet be there at the next start.
///
/// A disk may take longer than a lamp tick: this is done by a thread of its own, without the program's urgency, and the
/// order is answered with "later" until it is done.
///
/// One folder belongs to one program: it is locked.

#pragma once

extern "C" {
#include "elmopp/store.h"
}

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

namespace elmopp {

/// What a file store asks of the system, so that a test can refuse each call in turn. They answer as the calls do.
struct FileCalls {
    int (*open)(const char *path, int flags, mode_t mode);
    ssize_t (*write)(int descriptor, const void *bytes, std::size_t length);
    int (*fsync)(int descriptor);
};

/// The system's own.
extern const FileCalls system_file_calls;

/// A folder that nobody else uses as long as this is there.
class StoreFolder {
  public:
    /// Throws BadRequest if it is no folder, cannot be written to, or is another program's.
    explicit StoreFolder(std::filesystem::path folder);
    ~StoreFolder();
    StoreFolder(const StoreFolder &) = delete;
    StoreFolder &operator=(const StoreFolder &) = delete;
    StoreFolder(StoreFolder &&) = delete;
    StoreFolder &operator=(StoreFolder &&) = delete;

    [[nodiscard]] const std::filesystem::path &path() const {
        return folder_;
    }

  private:
    std::filesystem::path folder_;
    int descriptor_ = -1;
};

class FileStore {
  public:
    /// Reads what is there; a file of another length is none. Throws BadRequest if one cannot be read.
    FileStore(std::filesystem::path folder, std::string name, std::uint32_t image_bytes,
              const FileCalls &calls = system_file_calls);

    /// What to open the store with; valid as long as this is there.
    [[nodiscard]] elmopp_store_medium_t medium() const;

    /// Carries out an order. ELMOPP_STORE_LATER while the disk is at it.
    elmopp_store_answer_t carry_out(const elmopp_store_order_t &order);

    /// Why the last one failed, for people; empty if it did not.
    [[nodiscard]] const std::string &trouble() const {
        return trouble_;
    }

  private:
    [[nodiscard]] std::filesystem::path file_of(std::uint32_t sector) const;
    void load(std::uint32_t sector);
    void put(std::uint32_t at, std::uint32_t word);
    elmopp_store_answer_t seal(const elmopp_store_order_t &order);

    std::filesystem::path folder_;
    std::string name_;
    FileCalls calls_;
    std::uint32_t slot_bytes_;
    std::uint32_t sector_bytes_;
    std::vector<std::uint32_t> words_; ///< of both sectors: images are used where they stand
    std::future<std::string> writing_; ///< why not; empty: it is on the disk
    std::string trouble_;
};

} // namespace elmopp

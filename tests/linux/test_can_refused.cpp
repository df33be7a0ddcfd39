// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// What the programs of the port say where the kernel gives them no CAN socket. Linux itself asks no privilege for one:
// it is a security module or a service's system call filter that refuses. Such a filter stands here for all of them, so
// that the test needs neither CAN nor another user.

extern "C" {
#include "unity.h"
}

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <string>

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int not_started = 99;

/// From now on, and in whatever is started, socket(PF_CAN) fails with this error.
bool refuse_can_sockets(int error) {
    constexpr std::uint16_t load = BPF_LD + BPF_W + BPF_ABS;
    constexpr std::uint16_t is_equal = BPF_JMP + BPF_JEQ + BPF_K;
    constexpr std::uint16_t answer = BPF_RET + BPF_K;
    std::array<sock_filter, 6> rules{{
        {load, 0, 0, offsetof(seccomp_data, nr)},
        {is_equal, 0, 3, SYS_socket},
        {load, 0, 0, offsetof(seccomp_data, args)}, // the low half, on a machine that stores it first
        {is_equal, 0, 1, PF_CAN},
        {answer, 0, 0, SECCOMP_RET_ERRNO + static_cast<std::uint32_t>(error)},
        {answer, 0, 0, SECCOMP_RET_ALLOW},
    }};
    const sock_fprog program{rules.size(), rules.data()};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

[[noreturn]] void become(const char *program, int error, int said) {
    (void)dup2(said, STDERR_FILENO);
    if (refuse_can_sockets(error)) {
        // Every kernel has "lo"; what kind of interface it is would come out when the socket is bound to it.
        (void)execl(program, program, "--can", "lo", "--site", ELMOPP_SITE, nullptr);
    }
    _exit(not_started);
}

void expect_refused(const char *program, int error, const std::string &words) {
    std::array<int, 2> ends{};
    TEST_ASSERT_EQUAL_INT(0, pipe(ends.data()));
    const pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        become(program, error, ends[1]);
    }
    (void)close(ends[1]);
    std::string said;
    std::array<char, 256> piece{};
    for (ssize_t got = 0; (got = read(ends[0], piece.data(), piece.size())) > 0;) {
        said.append(piece.data(), static_cast<std::size_t>(got));
    }
    (void)close(ends[0]);
    int status = 0;
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE_MESSAGE(WIFEXITED(status), said.c_str());
    TEST_ASSERT_EQUAL_INT_MESSAGE(2, WEXITSTATUS(status), said.c_str());
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, std::count(said.begin(), said.end(), '\n'), said.c_str());
    TEST_ASSERT_TRUE_MESSAGE(said.find("--can lo: " + words) != std::string::npos, said.c_str());
}

void test_without_permission_it_is_one_line() {
    const std::string words = "no permission to open a raw CAN socket; right would be a user, or a service, that may";
    for (const char *const program : {ELMOPP_CONTROLLER, ELMOPP_LAMP_NODE, ELMOPP_MONITOR_TOOL, ELMOPP_VIEW}) {
        expect_refused(program, EPERM, words);
    }
    expect_refused(ELMOPP_LAMP_NODE, EACCES, words);
}

void test_without_can_in_the_kernel_it_is_one_line() {
    expect_refused(ELMOPP_LAMP_NODE, EAFNOSUPPORT, "this kernel has no CAN; right would be");
}

void test_any_other_reason_is_said_in_the_systems_words() {
    expect_refused(ELMOPP_LAMP_NODE, EMFILE, "Too many open files");
}

} // namespace

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_without_permission_it_is_one_line);
    RUN_TEST(test_without_can_in_the_kernel_it_is_one_line);
    RUN_TEST(test_any_other_reason_is_said_in_the_systems_words);
    return UNITY_END();
}

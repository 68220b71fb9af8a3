// As frames.c, through the C++ wrapper.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

#include "untangled.hpp"

template <class T> static std::vector<T> read_array(std::ifstream &file, std::size_t count) {
    std::vector<T> array(count);
    file.read(reinterpret_cast<char *>(array.data()), static_cast<std::streamsize>(sizeof(T) * count));
    return array;
}

template <class T> static void write(std::ofstream &file, untangled::Span<const T> array) {
    file.write(reinterpret_cast<const char *>(array.data()), static_cast<std::streamsize>(sizeof(T) * array.size()));
}

int main(int argc, char **argv) {
    if (argc < 4) {
        return 2;
    }
    std::ifstream file(argv[2], std::ios::binary);
    std::ofstream out(argv[3], std::ios::binary);
    const std::size_t repeats = argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 1;
    const auto counts = read_array<std::uint32_t>(file, 3);
    const std::size_t num_vertices = counts[0], num_frames = counts[2];
    untangled::Cloth cloth;
    cloth.num_vertices = num_vertices;
    cloth.triangles = read_array<std::array<std::uint32_t, 3>>(file, counts[1]);
    cloth.masses_kg = read_array<double>(file, num_vertices);
    cloth.correction = UNTANGLED_FORCE;
    cloth.paths = repeats == 1;
    const auto frames = read_array<float>(file, 3 * num_vertices * num_frames);

    const auto deadline = std::chrono::seconds(60);
    untangled::Client client(argv[1], deadline);
    auto session = client.open(cloth);
    std::vector<double> times;
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t k = 0; k < num_frames; ++k) {
            const auto begin = std::chrono::steady_clock::now();
            auto frame = session.begin_frame(0.0, 0.01);
            std::memcpy(frame.positions().data(), &frames[3 * num_vertices * k], 12 * num_vertices);
            const auto correction = session.wait(frame.send(), deadline);
            const auto end = std::chrono::steady_clock::now();
            times.push_back(std::chrono::duration<double, std::micro>(end - begin).count());
            if (repeat == 0) {
                write(out, correction.vertices());
                write(out, correction.paths());
                const auto &view = correction.summary();
                write(out, untangled::Span<const untangled_path_point>(view.path_points, view.num_path_points));
            }
        }
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    std::printf("%.3f\n", times[times.size() / 2]);
    return out.good() ? 0 : 2;
}

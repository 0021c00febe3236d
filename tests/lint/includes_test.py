"""The include check finds each kind of wrong #include, and passes the right ones."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).with_name("includes")


def check(files: dict):
    """Exit status and output of the check over a tree of {path: text}."""
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            file = Path(root, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        run = subprocess.run([sys.executable, CHECK, root], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout


class Includes(unittest.TestCase):
    def refuses(self, path, include, why):
        status, output = check({path: f"// first\n#include {include}\n", "client/lib/session.h": "", "server/base/result.h": ""})
        self.assertEqual(status, 1, output)
        self.assertIn(f"{path}:2:", output)
        self.assertIn(why, output)

    def test_upward_is_right(self):
        status, output = check({
            "server/render/frame.cpp": '#include "accel/tlas.h"\n#include "scene/scene.h"\n#include <vulkan/vulkan.h>\n#include "shared/frame.h"\n',
            "server/service/worlds.cpp": '#include "telemetry/log.h"\n#include "heliograph/v1/world.pb.h"\n#include <grpcpp/grpcpp.h>\n',
            "server/main.cpp": '#include "service/worlds.h"\n',
            "client/cli/main.cpp": '#include "lib/session.h"\n#include "render/renderer.h"\n',
        })
        self.assertEqual(status, 0, output)

    def test_downward(self):
        self.refuses("server/accel/tlas.h", '"render/frame.h"', "accel/ must not include render/")

    def test_independent_folders(self):
        self.refuses("server/scene/scene.h", '"gpu/device.h"', "scene/ stands alone")
        self.refuses("server/store/sqlite.cpp", '"world/world.h"', "store/ stands alone")

    def test_client_in_server(self):
        self.refuses("server/service/worlds.cpp", '"client/lib/session.h"', "must not include client/")
        self.refuses("server/service/worlds.cpp", '"lib/session.h"', "must not include lib/")

    def test_vulkan_and_wire(self):
        self.refuses("server/world/world.cpp", "<vulkan/vulkan.h>", "knows no Vulkan")
        self.refuses("server/scene/scene.cpp", "<volk.h>", "knows no Vulkan")
        self.refuses("server/world/world.cpp", '"heliograph/v1/world.pb.h"', "knows no gRPC")
        self.refuses("server/gpu/device.cpp", "<grpcpp/grpcpp.h>", "knows no gRPC")

    def test_relative(self):
        self.refuses("server/scene/city.cpp", '"../base/result.h"', "without ../")

    def test_unknown_folder(self):
        status, output = check({"server/misc/tools.h": ""})
        self.assertEqual(status, 1, output)
        self.assertIn("server/misc/", output)


if __name__ == "__main__":
    unittest.main()

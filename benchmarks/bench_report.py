"""Frames a second of a report that plays in a real browser without a GPU, its size, and what it waits for.

    .venv/bin/python benchmarks/bench_report.py [minutes]

Needs the extra oracle (playwright) and Chromium.
"""

import shutil
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from kreisel.show import write_report
from kreisel.study.run import Result, run
from kreisel.study.scenario import Scenario

SCENARIO = Path(__file__).resolve().parents[1] / "examples" / "scenarios" / "figure_1.toml"
SECONDS, ROUNDS = 5.0, 5

# A frame counts when the browser asks for it, as the page's own do.
COUNT = """seconds => new Promise(resolve => {
  kreisel.seek(kreisel.data.start);
  kreisel.play(true);
  let [frames, worst, first, last] = [0, 0, 0, 0];
  const tick = now => {
    if (!first) first = now;
    else { frames += 1; worst = Math.max(worst, now - last); }
    last = now;
    if (now - first < 1000 * seconds) return requestAnimationFrame(tick);
    kreisel.play(false);
    resolve([frames / ((now - first) / 1000), worst]);
  };
  requestAnimationFrame(tick);
})"""

TURN = """() => {
  const start = performance.now();
  for (let k = 0; k < 30; k++) kreisel.scene.turn(1, 0);
  return (performance.now() - start) / 30;
}"""


def made(minutes: float) -> Result:
    text = SCENARIO.read_text().replace("duration = 60.0", f"duration = {60.0 * minutes}")
    return run(Scenario.from_toml(text))


def measure(page: Page, what: str) -> None:
    found = sorted(page.evaluate(COUNT, SECONDS) for _ in range(ROUNDS))
    rates = [rate for rate, _ in found]
    print(f"{what:<34} {rates[ROUNDS // 2]:.0f} frames/s ({rates[0]:.0f} to {rates[-1]:.0f}), "
          f"longest frame {max(worst for _, worst in found):.0f} ms")  # fmt: skip


def main(minutes: float) -> None:
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        result = made(minutes)
        started = time.perf_counter()
        path = write_report(result, Path(folder) / "report.html")
        print(f"{len(result.motion)} samples: {path.stat().st_size / 1e6:.2f} MB, "
              f"written in {time.perf_counter() - started:.1f} s")  # fmt: skip
        chromium = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        page = chromium.new_page(viewport={"width": 1440, "height": 900})
        started = time.perf_counter()
        page.goto(path.as_uri())
        page.wait_for_selector("[data-ready]", state="attached")
        print(f"ready after {time.perf_counter() - started:.1f} s")
        page.wait_for_timeout(1000)
        measure(page, "playing, the body in view")
        page.evaluate("scrollTo(0, 700)")
        measure(page, "playing, six charts in view")
        page.set_viewport_size({"width": 1440, "height": 2100})
        measure(page, "playing, body and nine charts")
        print(f"the eye turned: {page.evaluate(TURN):.1f} ms a picture")
        chromium.close()


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 10.0)

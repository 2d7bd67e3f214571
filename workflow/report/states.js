// The virial series of a chosen packing fraction, on the data of the figures.
const series = JSON.parse(document.getElementById("states-data").textContent);
const WIDTH = 480, HEIGHT = 260, LEFT = 56, BOTTOM = 40, TOP = 30, RIGHT = 12;
const scale = (low, high, from, to, log) => {
  const at = log ? Math.log10 : x => x;
  return x => from + (at(x) - at(low)) / (at(high) - at(low)) * (to - from);
};
const text = (x, y, content, anchor) => `<text x="${x}" y="${y}" text-anchor="${anchor}">${content}</text>`;
const line = (points, kind) => `<polyline class="${kind}" points="${points.map(point => point.join(",")).join(" ")}"/>`;
const axes = (xs, ys, xTicks, yTicks, xLabel, yLabel) =>
  line([[LEFT, TOP], [LEFT, HEIGHT - BOTTOM], [WIDTH - RIGHT, HEIGHT - BOTTOM]], "frame")
  + xTicks.map(([x, name]) => text(xs(x), HEIGHT - BOTTOM + 16, name, "middle")).join("")
  + yTicks.map(([y, name]) => text(LEFT - 6, ys(y) + 4, name, "end")).join("")
  + text((LEFT + WIDTH) / 2, HEIGHT - 6, xLabel, "middle") + text(4, 14, yLabel, "start");
const three = x => Number(x.toPrecision(3)).toString();
const percent = x => `${three(100 * x)} %`;

const virial = document.getElementById("states"), kind = virial.querySelector("select");
const packing = virial.querySelector("input"), sums = virial.querySelector("svg"), sentence = virial.querySelector("output");
const drawSeries = () => {
  const gas = series[kind.value], n = Number(packing.value), eta = gas.packing_fraction[n], z = gas.reference[n];
  const parts = gas.sums.map(one => one[n]);
  const top = Math.max(z, ...parts) * 1.08;
  const xs = scale(1, 10, LEFT + 14, WIDTH - RIGHT - 14), ys = scale(0, top, HEIGHT - BOTTOM, TOP);
  const step = top > 8 ? 4 : top > 4 ? 2 : 1, ticks = [];
  for (let y = 0; y <= top; y += step) ticks.push([y, y]);
  sums.innerHTML = axes(xs, ys, parts.map((_, k) => [k + 1, k + 1]), ticks, "series cut after this virial coefficient", "Z")
    + line([[LEFT, ys(z)], [WIDTH - RIGHT, ys(z)]], "reference")
    + parts.map((part, k) => `<circle cx="${xs(k + 1)}" cy="${ys(part)}" r="5"/>`).join("");
  const lacks = 1 - parts[3] / z, [etas, values, errors] = gas.measured;
  const near = etas.findIndex(other => Math.abs(other - eta) < 0.004);
  sentence.textContent = `Packing fraction ${three(eta)}: Z = ${three(z)} (line). The series to the fourth coefficient lacks ${percent(Math.abs(lacks))}.`
    + (near < 0 ? "" : ` Measured: ${values[near]} ± ${three(errors[near])}.`);
};
[kind, packing].forEach(one => one.addEventListener("input", drawSeries));

drawSeries();

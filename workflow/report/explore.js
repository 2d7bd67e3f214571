// Two explanations to be tried out, on the data of the figures: the virial series and the cost of an accuracy.
const stored = JSON.parse(document.getElementById("explore-data").textContent);
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

const virial = document.getElementById("explore-virial"), kind = virial.querySelector("select");
const packing = virial.querySelector("input"), sums = virial.querySelector("svg"), sentence = virial.querySelector("output");
const drawSeries = () => {
  const gas = stored.series[kind.value], n = Number(packing.value), eta = gas.packing_fraction[n], z = gas.reference[n];
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

const cost = document.getElementById("explore-cost"), scene = cost.querySelector("select");
const wanted = cost.querySelector("input"), curves = cost.querySelector("svg"), choice = cost.querySelector("output");
const NAMES = { event: "the event-driven engine", step: "time steps" };
const drawCost = () => {
  const one = stored.costs[scene.value], n = Number(wanted.value), engines = Object.entries(one.seconds);
  const all = engines.flatMap(([, seconds]) => seconds).filter(seconds => seconds !== null);
  const low = 10 ** Math.floor(Math.log10(Math.min(...all))), high = 10 ** Math.ceil(Math.log10(Math.max(...all)));
  const xs = scale(one.accuracy[0], one.accuracy.at(-1), LEFT + 14, WIDTH - RIGHT - 14, true);
  const ys = scale(low, high, HEIGHT - BOTTOM, TOP, true);
  const xTicks = one.accuracy.filter(x => Number.isInteger(Math.round(1e6 * Math.log10(x)) / 1e6)).map(x => [x, percent(x)]);
  const yTicks = [];
  for (let y = low; y <= high * 1.001; y *= 10) yTicks.push([y, three(y)]);
  curves.innerHTML = axes(xs, ys, xTicks, yTicks, "required accuracy", "seconds")
    + line([[xs(one.accuracy[n]), TOP], [xs(one.accuracy[n]), HEIGHT - BOTTOM]], "reference")
    + engines.map(([name, seconds]) => line(
      seconds.map((y, k) => [y, one.accuracy[k]]).filter(([y]) => y !== null).map(([y, x]) => [xs(x), ys(y)]), name)).join("");
  const known = engines.map(([name, seconds]) => [name, seconds[n]]).filter(([, y]) => y !== null).sort((a, b) => a[1] - b[1]);
  choice.textContent = known.length === 0 ? "No engine reaches this accuracy." : `Least for ${percent(one.accuracy[n])}: ${NAMES[known[0][0]]}, ${three(known[0][1])} s`
    + known.slice(1).map(([name, y]) => `; ${NAMES[name]}, ${three(y)} s`).join("") + ".";
};
scene.addEventListener("input", drawCost);
wanted.addEventListener("input", drawCost);
drawSeries();
drawCost();

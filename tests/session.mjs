// A session of changes in node: the state after each, as a digest. Arguments: gas.js, the data of a page, steps.
import crypto from "node:crypto";
import fs from "node:fs";
import { createRequire } from "node:module";
const [script, page, steps] = process.argv.slice(2), { Gas, dataOf, startOf } = createRequire(import.meta.url)(script);
const data = await dataOf(fs.readFileSync(page, "utf8")), results = [];
let state = null;
for (const { start, values, reverse, piston, duration } of JSON.parse(fs.readFileSync(steps))) {
  const gas = await Gas.of(data, start, values);
  state ??= startOf(data, start);
  if (reverse) state.velocities.forEach((v, n, all) => { all[n] = -v; });
  gas.begin(piston ? { ...state, piston } : state);
  const cpu = process.cpuUsage(), events = gas.advance(duration), { user } = process.cpuUsage(cpu);
  state = gas.state;
  const hash = crypto.createHash("sha256");
  for (const array of [state.positions, state.velocities, state.images, state.spins, Float64Array.from(state.piston ?? [])])
    hash.update(Buffer.from(array.buffer, array.byteOffset, array.byteLength));
  results.push({ digest: hash.digest("hex"), time: gas.time, collisions: gas.collisions, hits: Array.from(gas.hits, Number),
    impulse: gas.impulse, events, seconds: user / 1e6 });
}
console.log(JSON.stringify(results));

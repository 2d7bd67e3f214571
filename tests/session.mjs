// A session of changes of a gas: the state after each, as a digest, and counters. Tests run it in node and in browsers.
async function session(Gas, startOf, data, steps) {
  const results = [], seconds = () => typeof process === "undefined" ? 0 : process.cpuUsage().user / 1e6;
  let state = null;
  for (const { start, values, reverse, piston, duration } of steps) {
    const gas = await Gas.of(data, start, values);
    state ??= startOf(data, start);
    if (reverse) state.velocities.forEach((v, n, all) => { all[n] = -v; });
    gas.begin(piston ? { ...state, piston } : state);
    const begin = seconds();
    gas.advance(duration);
    const spent = seconds() - begin;
    state = gas.state;
    const arrays = [state.positions, state.velocities, state.images, state.spins, Float64Array.from(state.piston ?? [])];
    const whole = new Uint8Array(await new Blob(arrays).arrayBuffer());
    const digest = Array.from(new Uint8Array(await crypto.subtle.digest("SHA-256", whole)), byte => byte.toString(16).padStart(2, "0"));
    results.push({ digest: digest.join(""), time: gas.time, collisions: gas.collisions, hits: Array.from(gas.hits, Number), impulse: gas.impulse, seconds: spent });
  }
  return results;
}
if (typeof process !== "undefined") {  // arguments: gas.js, the data of a page, steps
  const fs = await import("node:fs"), { inflateSync } = await import("node:zlib"), { createRequire } = await import("node:module");
  const [script, page, steps] = process.argv.slice(2), { Gas, dataOf, startOf } = createRequire(script)(script);
  const data = dataOf(new Uint8Array(inflateSync(Buffer.from(fs.readFileSync(page, "utf8"), "base64"))));
  console.log(JSON.stringify(await session(Gas, startOf, data, JSON.parse(fs.readFileSync(steps)))));
}

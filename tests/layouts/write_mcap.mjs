// write_mcap.mjs MESSAGES OUT: the messages of bag_messages.py as MCAP files of all kinds, by the format's own writer, and each message
// as CDR in MESSAGES/N.cdr for write_db3.py. Needs npm's @mcap/core, @foxglove/rosmsg2-serialization, @foxglove/rosmsg,
// @foxglove/rosmsg-msgs-common, @foxglove/wasm-zstd and lz4js beside the folder it is called in.
import { createRequire } from "node:module";
import fs from "node:fs";
import path from "node:path";
const require = createRequire(path.join(process.cwd(), "package.json"));
const { McapWriter } = require("@mcap/core");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { stringify } = require("@foxglove/rosmsg");
const { ros2galactic } = require("@foxglove/rosmsg-msgs-common");
const zstd = require("@foxglove/wasm-zstd");
const lz4 = require("lz4js");
await zstd.isLoaded;

const [folder, out, only] = process.argv.slice(2);
const messages = JSON.parse(fs.readFileSync(path.join(folder, "messages.json")));

const field = (type, name, more) => ({ type, name, isComplex: type.includes("/"), isArray: false, ...more });
const livox = {
  "livox_ros_driver2/CustomMsg": [
    field("std_msgs/Header", "header"), field("uint64", "timebase"), field("uint32", "point_num"), field("uint8", "lidar_id"),
    field("uint8", "rsvd", { isArray: true, arrayLength: 3 }), field("livox_ros_driver2/CustomPoint", "points", { isArray: true })],
  "livox_ros_driver2/CustomPoint": [
    field("uint32", "offset_time"), field("float32", "x"), field("float32", "y"), field("float32", "z"),
    field("uint8", "reflectivity"), field("uint8", "tag"), field("uint8", "line")],
};

// A type and all that it consists of.
function definitions(type) {
  const found = [];
  const visit = (name) => {
    if (found.some((d) => d.name === name)) return;
    const definition = livox[name] ? { definitions: livox[name] } : ros2galactic[name.replace("/msg/", "/")] ?? ros2galactic[name];
    found.push({ name, definitions: definition.definitions });
    for (const field of definition.definitions) if (field.isComplex) visit(field.type);
  };
  visit(type);
  return found;
}

// ROS 2 has small letters where ROS 1 has D, K, R and P.
function ros2(value, type) {
  if (!type.endsWith("CameraInfo")) return value;
  const { D, K, R, P, ...rest } = value;
  return { ...rest, d: D, k: K, r: R, p: P };
}

function filled(value) {
  if (Array.isArray(value)) return value.map(filled);
  if (value === null || typeof value !== "object") return value;
  if (value.timebase) value = { ...value, timebase: BigInt(value.timebase) };
  if (value.bytes) return new Uint8Array(fs.readFileSync(path.join(folder, value.bytes)));
  return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, typeof v === "bigint" ? v : filled(v)]));
}

const types = new Map();
for (const { type } of messages)
  if (!types.has(type)) {
    const parts = definitions(type);
    types.set(type, { writer: new MessageWriter(parts), text: stringify(parts) });
  }
const cdr = messages.map((m) => types.get(m.type).writer.writeMessage(filled(ros2(m.value, m.type))));
cdr.forEach((bytes, i) => fs.writeFileSync(path.join(folder, `${i}.cdr`), bytes));

async function write(name, options) {
  if (only && name !== only) return;
  const file = fs.openSync(path.join(out, name), "w");
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => { fs.writeSync(file, bytes); position += BigInt(bytes.length); },
  };
  const writer = new McapWriter({ writable, chunkSize: 8192, ...options });
  await writer.start({ profile: "ros2", library: "test" });
  const channels = new Map();
  for (const [i, m] of messages.entries()) {
    if (!channels.has(m.topic)) {
      const schemaId = await writer.registerSchema({
        name: m.type.replace("/", "/msg/"), encoding: "ros2msg", data: new TextEncoder().encode(types.get(m.type).text) });
      channels.set(m.topic, await writer.registerChannel({ schemaId, topic: m.topic, messageEncoding: "cdr", metadata: new Map() }));
    }
    const time = BigInt(m.time);
    await writer.addMessage({ channelId: channels.get(m.topic), sequence: i, logTime: time, publishTime: time, data: cdr[i] });
  }
  await writer.end();
  fs.closeSync(file);
}

const unindexed = { useMessageIndex: false, useChunkIndex: false, useSummaryOffsets: false, useStatistics: false, repeatSchemas: false,
                    repeatChannels: false };
fs.mkdirSync(out, { recursive: true });
await write("zstd.mcap", { compressChunk: (data) => ({ compression: "zstd", compressedData: zstd.compress(data, 19) }) });
await write("lz4_without_index.mcap",
            { ...unindexed, compressChunk: (data) => ({ compression: "lz4", compressedData: lz4.compress(data) }) });
await write("without_chunks.mcap", { useChunks: false });
await write("plain.mcap", {});

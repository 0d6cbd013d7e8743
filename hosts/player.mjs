// Plays a capsule by WebGPU, in Node or in a browser alike: docs/hosts.md describes what is read and what is handed back.
//
// Nothing of Isophote's is known here but the capsule's own words, which are WebGPU's. What the G-buffer is made of is
// handed back as raw bytes; `isophote capsule read` makes it.

const SCHEMA = 'isophote-capsule';
const VERSION = 1;

/** 64-bit FNV-1a of bytes, 16 hexadecimal digits: the prime is 2^40 + 0x1b3. */
export function hash(bytes) {
  let low = 0x84222325;
  let high = 0xcbf29ce4;
  for (const byte of bytes) {
    low = (low ^ byte) >>> 0;
    const product = low * 0x1b3;
    high = (Math.imul(high, 0x1b3) + Math.floor(product / 2 ** 32) + (low << 8)) >>> 0;
    low = product % 2 ** 32;
  }
  return [high, low].map((half) => half.toString(16).padStart(8, '0')).join('');
}

/** The capsule's document and its files by name, each with the length and hash that the document states. */
async function opened(read) {
  const text = await read('capsule.json');
  const capsule = JSON.parse(new TextDecoder().decode(text));
  if (capsule.schema !== SCHEMA) throw new Error(`capsule.json: schema is not ${SCHEMA}`);
  if (capsule.schemaVersion !== VERSION) {
    throw new Error(`capsule.json: schemaVersion ${capsule.schemaVersion}, where this host reads ${VERSION}`);
  }
  const files = new Map();
  for (const { name, bytes, hash: expected } of capsule.files) {
    const found = await read(name);
    if (found.length !== bytes) throw new Error(`${name}: ${found.length} bytes, not ${bytes}`);
    const own = hash(found);
    if (own !== expected) throw new Error(`${name}: hash ${own}, not ${expected}`);
    files.set(name, found);
  }
  return { capsule, files, id: hash(text) };
}

/** What an adapter says of itself, in the words of an answer. */
function hostOf(adapter, compiler) {
  const { vendor, architecture, device, description } = adapter.info;
  return {
    adapter: device || architecture || vendor || 'unnamed',
    driver: description || `${vendor} ${architecture}`.trim(),
    backend: 'webgpu',
    compiler,
  };
}

/** Who would answer: an adapter of `gpu`, in the words of an answer. */
export async function host(gpu, compiler) {
  const adapter = await gpu.requestAdapter();
  if (!adapter) throw new Error('there is no adapter');
  return hostOf(adapter, compiler);
}

/** Makes everything that a capsule has. */
async function made(device, { capsule, files }) {
  const buffers = capsule.buffers.map((buffer) => device.createBuffer(buffer));
  const textures = capsule.textures.map(({ label, format, width, height, usage }) =>
    device.createTexture({ label, format, usage, size: [width, height] }));
  const views = textures.map((texture) => texture.createView());
  const resource = ({ buffer, texture }) =>
    buffer ? { buffer: buffers[buffer.buffer], offset: buffer.offset, size: buffer.size } : views[texture];
  const layouts = capsule.groupLayouts.map(({ entries }) => device.createBindGroupLayout({
    entries: entries.map(({ binding, visibility, resource }) => ({ binding, visibility, ...resource })),
  }));
  const groups = capsule.groups.map(({ layout, entries }) => device.createBindGroup({
    layout: layouts[layout],
    entries: entries.map((entry) => ({ binding: entry.binding, resource: resource(entry.resource) })),
  }));
  const pipelineLayouts = capsule.pipelineLayouts.map((all) => device.createPipelineLayout({
    bindGroupLayouts: all.map((layout) => (layout === null ? null : layouts[layout])),
  }));
  const modules = capsule.modules.map(({ file }) =>
    device.createShaderModule({ label: file, code: new TextDecoder().decode(files.get(file)) }));
  const stage = ({ module, entryPoint, constants }) => ({ module: modules[module], entryPoint, constants });
  const compute = capsule.computePipelines.map((pipeline) => device.createComputePipeline({
    layout: pipelineLayouts[pipeline.layout],
    compute: stage(pipeline.compute),
  }));
  const render = capsule.renderPipelines.map((pipeline) => device.createRenderPipeline({
    layout: pipelineLayouts[pipeline.layout],
    vertex: { ...stage(pipeline.vertex), buffers: pipeline.buffers },
    fragment: { ...stage(pipeline.fragment), targets: pipeline.targets },
    primitive: { topology: 'triangle-list' },
    ...(pipeline.depth && { depthStencil: pipeline.depth }),
  }));
  return { buffers, textures, views, groups, compute, render };
}

const COMPUTE_STEPS = {
  pipeline: (pass, objects, index) => pass.setPipeline(objects.compute[index]),
  group: (pass, objects, { index, group, offsets }) => pass.setBindGroup(index, objects.groups[group], offsets),
  dispatch: (pass, objects, groups) => pass.dispatchWorkgroups(...groups),
};

const RENDER_STEPS = {
  pipeline: (pass, objects, index) => pass.setPipeline(objects.render[index]),
  group: (pass, objects, { index, group, offsets }) => pass.setBindGroup(index, objects.groups[group], offsets),
  viewport: (pass, objects, all) => pass.setViewport(...all),
  vertexBuffer: (pass, objects, { slot, range }) =>
    pass.setVertexBuffer(slot, objects.buffers[range.buffer], range.offset, range.size),
  indexBuffer: (pass, objects, { format, range }) =>
    pass.setIndexBuffer(objects.buffers[range.buffer], format, range.offset, range.size),
  draw: (pass, objects, counts) => pass.draw(...counts),
  drawIndexed: (pass, objects, counts) => pass.drawIndexed(...counts),
  drawIndexedIndirect: (pass, objects, { buffer, offset }) => pass.drawIndexedIndirect(objects.buffers[buffer], offset),
};

/** Takes the steps of a pass; one of a name that is not known ends the play. */
function walk(pass, known, objects, steps) {
  for (const step of steps) {
    const [[name, value]] = Object.entries(step);
    if (!known[name]) throw new Error(`step ${name} is not known`);
    known[name](pass, objects, value);
  }
  pass.end();
}

const COMMANDS = {
  clear: (encoder, objects, { buffer, offset, size }) => encoder.clearBuffer(objects.buffers[buffer], offset, size),
  compute: (encoder, objects, { steps }) => walk(encoder.beginComputePass(), COMPUTE_STEPS, objects, steps),
  render: (encoder, objects, { colors, depth, steps }) => {
    const ops = (clear) => (clear === null ? { loadOp: 'load' } : { loadOp: 'clear', clearValue: clear });
    const pass = encoder.beginRenderPass({
      colorAttachments: colors.map(({ texture, clear }) =>
        ({ view: objects.views[texture], ...ops(clear), storeOp: 'store' })),
      ...(depth && {
        depthStencilAttachment: {
          view: objects.views[depth.texture],
          ...(depth.clear === null ? { depthLoadOp: 'load' } : { depthLoadOp: 'clear', depthClearValue: depth.clear }),
          depthStoreOp: depth.store ? 'store' : 'discard',
        },
      }),
    });
    walk(pass, RENDER_STEPS, objects, steps);
  },
};

/** Bytes of a texel of the formats that are read. */
const TEXEL = { rgba32uint: 16, rgba32float: 16, rgba8unorm: 4, r8unorm: 1 };

/** Copies what is to be read, and hands it back without padding. */
async function read(device, objects, of) {
  const encoder = device.createCommandEncoder();
  const copy = (size) => device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  let staging, rows;
  if (of.buffer) {
    staging = copy(of.buffer.size);
    encoder.copyBufferToBuffer(objects.buffers[of.buffer.buffer], of.buffer.offset, staging, 0, of.buffer.size);
  } else {
    const texture = objects.textures[of.texture];
    const row = texture.width * TEXEL[texture.format];
    rows = { row, stride: Math.ceil(row / 256) * 256, height: texture.height };
    staging = copy(rows.stride * rows.height);
    encoder.copyTextureToBuffer({ texture }, { buffer: staging, bytesPerRow: rows.stride }, [texture.width, texture.height]);
  }
  device.queue.submit([encoder.finish()]);
  await staging.mapAsync(GPUMapMode.READ);
  const all = new Uint8Array(staging.getMappedRange().slice(0));
  staging.destroy();
  if (!rows) return all;
  const tight = new Uint8Array(rows.row * rows.height);
  for (let y = 0; y < rows.height; y += 1) {
    tight.set(all.subarray(y * rows.stride, y * rows.stride + rows.row), y * rows.row);
  }
  return tight;
}

/**
 * Plays the capsule whose files `file(name)` reads, on an adapter of `gpu`.
 *
 * Returns the answer's files by name, `answer.json` among them. Whatever WebGPU refuses is thrown.
 */
export async function play(gpu, file, compiler) {
  const contents = await opened(file);
  const adapter = await gpu.requestAdapter();
  if (!adapter) throw new Error('there is no adapter');
  const device = await adapter.requestDevice({ requiredLimits: contents.capsule.limits });
  const complaints = [];
  device.addEventListener('uncapturederror', (event) => complaints.push(event.error.message));
  device.lost.then(({ reason, message }) => reason !== 'destroyed' && complaints.push(`the device was lost: ${message}`));
  const scopes = ['validation', 'out-of-memory', 'internal'];
  scopes.forEach((scope) => device.pushErrorScope(scope));
  const objects = await made(device, contents);
  for (const command of contents.capsule.commands) {
    const [[name, value]] = Object.entries(command);
    if (name === 'write') {
      device.queue.writeBuffer(objects.buffers[value.buffer], value.offset, contents.files.get(value.file));
      continue;
    }
    if (!COMMANDS[name]) throw new Error(`command ${name} is not known`);
    const encoder = device.createCommandEncoder();
    COMMANDS[name](encoder, objects, value);
    device.queue.submit([encoder.finish()]);
  }
  await device.queue.onSubmittedWorkDone();
  const answer = new Map();
  for (const { name, of } of contents.capsule.reads) answer.set(`${name}.bin`, await read(device, objects, of));
  for (const scope of scopes) {
    const error = await device.popErrorScope();
    if (error) complaints.push(error.message);
  }
  if (complaints.length > 0) throw new Error(complaints.join('\n'));
  device.destroy();
  const files = [...answer].map(([name, bytes]) => ({ name, bytes: bytes.length, hash: hash(bytes) }));
  const document = {
    schema: 'isophote-answer',
    schemaVersion: 1,
    capsule: contents.id,
    host: hostOf(adapter, compiler),
    files,
  };
  answer.set('answer.json', new TextEncoder().encode(JSON.stringify(document, null, 2)));
  return answer;
}

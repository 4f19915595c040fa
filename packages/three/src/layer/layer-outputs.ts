import {
  Fn,
  float,
  If,
  Loop,
  logarithmicDepthToViewZ,
  max,
  mrt,
  screenCoordinate,
  select,
  uniform,
  uniformArray,
  vec2,
  vec4,
  velocity,
} from 'three/tsl';
import {
  type Camera,
  DataTexture,
  ExternalTexture,
  FloatType,
  Matrix4,
  type MRTNode,
  type Node,
  type NodeBuilder,
  type PerspectiveCamera,
  RedIntegerFormat,
  RGBAFormat,
  RGBAIntegerFormat,
  RGIntegerFormat,
  type Texture,
  UnsignedByteType,
  Vector2,
  type WebGPURenderer,
} from 'three/webgpu';
import { splatEngineOf } from '../renderer/adopt-renderer.ts';
import type { OpenPass, RendererInternals, TextureData } from '../renderer/three-bridge.ts';
import { DepthLayerMaterial, noDepth } from './depth-material.ts';
import type { LayerCloud } from './layer-cloud.ts';
import { ColorLayerMaterial, ViewportImage } from './layer-material.ts';
import { MOST_MOTIONS, type Motion, motionBetween, type Pose, PoseHistory } from './layer-motion.ts';
import type { LayerView } from './layer-view.ts';

const INTEGER_FORMATS: readonly number[] = [RedIntegerFormat, RGIntegerFormat, RGBAIntegerFormat];

/** Returns the nodes to write instead of `outputs`, into textures with their names. */
type OutputsOf = (outputs: MRTNode, textures: readonly Texture[]) => MRTNode;

/** Writes the results of `outputsOf` into the outputs of a pass with several. */
class OutputsLayerMaterial extends ColorLayerMaterial {
  readonly #outputsOf: OutputsOf;

  constructor(outputsOf: OutputsOf) {
    super();
    this.#outputsOf = outputsOf;
  }

  override setup(builder: NodeBuilder): void {
    const outputs = builder.renderer.getMRT();
    // Reset afterwards: three would write the outputs into passes with one output, too.
    const textures = builder.renderer.getRenderTarget()?.textures ?? [];
    this.mrtNode = outputs && this.#outputsOf(outputs, textures);
    super.setup(builder);
    this.mrtNode = null;
  }

  /** three must not take the shaders of another material with the same nodes. */
  override customProgramCacheKey(): string {
    return `${super.customProgramCacheKey()} outputs`;
  }
}

/**
 * Outputs of a layer besides its colours: depth, and the outputs of passes that have several, such
 * as normals and motion. Splats write these where they write depth. All outputs keep the values of
 * the meshes behind elsewhere.
 *
 * Motion is like three's `velocity` of meshes, the difference of normalised device coordinates from
 * the frame before, and is written to the output that has this name.
 */
export class LayerOutputs {
  /** Replaces the layer's first material. */
  readonly colorMaterial = new OutputsLayerMaterial((...pass) => this.#outputsOf(...pass));
  readonly depthMaterial = new DepthLayerMaterial();
  readonly #depth = new ViewportImage(noDepth());
  /** Outputs behind the splats, by name and kind: float32 is bound in another way. */
  readonly #behind = new Map<string, ViewportImage>();
  readonly #motion = new MotionUniforms();

  /**
   * Prepares for the draw of the image that `view` has just made for a part of `pass`, and keeps
   * the outputs behind the splats. Call while the pass is interrupted. If several cameras draw at
   * once, outputs keep the meshes' values.
   */
  show(
    view: LayerView,
    renderer: WebGPURenderer,
    pass: OpenPass,
    part: number,
    encoder: GPUCommandEncoder,
  ): void {
    const { camera, host } = pass.parts[part];
    const isAlone = pass.parts.length === 1;
    this.#depth.show(isAlone ? view.depth : null, view.xPx, view.yPx);
    const outputs = renderer.getMRT();
    const { behind, history } = outputsOfView(view);
    for (const name of otherOutputs(outputs)) {
      const texture = outputTexture(renderer, name);
      // Integer textures cannot be read by the same nodes.
      if (!texture || texture.format.endsWith('int')) continue;
      const copy = fittingCopy(behind.get(name), texture, splatEngineOf(renderer).device);
      behind.set(name, copy);
      const source = { texture, origin: [0, 0, host.layer ?? 0] };
      const destination = { texture: copy.sourceTexture as GPUTexture };
      encoder.copyTextureToTexture(source, destination, [texture.width, texture.height]);
      this.#behindOf(name, copy.type === FloatType).show(copy);
    }
    if (!isAlone || !outputs?.has('velocity')) return;
    const pose = poseOf(view.clouds.keys(), camera);
    // Not the camera's own inverse: mirrors change the projection alone.
    const ndcToWorld = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).invert();
    const previous = history.before(renderer.info.frame, pose);
    this.#motion.set(motionBetween(previous, pose, ndcToWorld), pass.parts[part], renderer);
  }

  /** Leaves the layer's material to it. */
  dispose(): void {
    this.depthMaterial.dispose();
    for (const image of [this.#depth, ...this.#behind.values()]) image.dispose();
  }

  /** three may build shaders before there is anything to show. */
  #behindOf(name: string, isFloat32: boolean): ViewportImage {
    const key = `${name} ${isFloat32}`;
    const image =
      this.#behind.get(key) ??
      new ViewportImage(
        isFloat32
          ? new DataTexture(new Float32Array(4), 1, 1, RGBAFormat, FloatType)
          : new DataTexture(new Uint8Array(4), 1, 1),
      );
    this.#behind.set(key, image);
    return image;
  }

  #outputsOf(outputs: MRTNode, textures: readonly Texture[]): MRTNode {
    const depth = this.#depth.texel.r;
    const entries = otherOutputs(outputs).map((name) => {
      const own: Node = name === 'velocity' ? this.#motion.velocityAt(depth) : outputs.get(name);
      const texture = textures.find((each) => each.name === name);
      if (!texture || INTEGER_FORMATS.includes(texture.format)) return [name, own];
      const behind = this.#behindOf(name, texture.type === FloatType);
      const written = own.convert('vec4') as Node<'vec4'>;
      return [name, select(depth.greaterThanEqual(0), written, behind.texel)];
    });
    return mrt(Object.fromEntries(entries));
  }
}

/** The values that motion is computed from, for the draw of one view. */
class MotionUniforms {
  readonly #originPx = uniform(new Vector2());
  readonly #sizePx = uniform(new Vector2());
  /** near and far of logarithmic depth; 0 for depth as the projection has it. */
  readonly #logarithmic = uniform(new Vector2());
  /** Factor and summand from the negated inverse of the view's z to normalised device z. */
  readonly #toNdcZ = uniform(new Vector2());
  readonly #toClip = uniform(new Matrix4());
  readonly #boxCount = uniform(0, 'int');
  readonly #toBoxes = matrices();
  readonly #boxesToPreviousClip = matrices();

  set(
    { toClip, boxes }: Motion,
    { camera, widthPx, heightPx, host: { xPx, yPx } }: OpenPass['parts'][number],
    { logarithmicDepthBuffer }: WebGPURenderer,
  ): void {
    const { near, far, isPerspectiveCamera } = camera as PerspectiveCamera;
    const projection = camera.projectionMatrix.elements;
    this.#originPx.value.set(xPx, yPx);
    this.#sizePx.value.set(widthPx, heightPx);
    if (logarithmicDepthBuffer && isPerspectiveCamera) this.#logarithmic.value.set(near, far);
    else this.#logarithmic.value.set(0, 0);
    this.#toNdcZ.value.set(projection[14], -projection[10]);
    this.#toClip.value.copy(toClip);
    this.#boxCount.value = boxes.length;
    boxes.forEach((box, i) => {
      (this.#toBoxes.array[i] as Matrix4).copy(box.toBox);
      (this.#boxesToPreviousClip.array[i] as Matrix4).copy(box.toPreviousClip);
    });
  }

  /** @param depth as it is stored. */
  velocityAt(depth: Node<'float'>): Node<'vec2'> {
    return Fn(() => {
      const inViewport = screenCoordinate.sub(this.#originPx).div(this.#sizePx);
      const { x: near, y: far } = this.#logarithmic;
      const inverseZ = logarithmicDepthToViewZ(depth, near, far).reciprocal().negate();
      const ofLogarithmic = inverseZ.mul(this.#toNdcZ.x).add(this.#toNdcZ.y);
      const ndcZ = select(far.greaterThan(0), ofLogarithmic, depth);
      const place = vec4(inViewport.mul(vec2(2, -2)).add(vec2(-1, 1)), ndcZ, 1).toVar();
      const before = vec4(place).toVar();
      const nearest = float(3e38).toVar();
      Loop(this.#boxCount, ({ i }: { i: Node<'int'> }) => {
        const inBox = elementOf(this.#toBoxes, i).mul(place).toVar();
        const farthest = inBox.xyz.div(inBox.w).abs().toVar();
        const distance = max(farthest.x, farthest.y, farthest.z, 1);
        If(distance.lessThanEqual(nearest), () => {
          nearest.assign(distance);
          before.assign(elementOf(this.#boxesToPreviousClip, i).mul(place));
        });
      });
      const now = this.#toClip.mul(place).toVar();
      return now.xy.div(now.w).sub(before.xy.div(before.w));
    })();
  }
}

function matrices() {
  return uniformArray(
    Array.from({ length: MOST_MOTIONS }, () => new Matrix4()),
    'mat4',
  );
}

/** three's types do not know the elements of an array. */
function elementOf(array: ReturnType<typeof matrices>, index: Node<'int'>): Node<'mat4'> {
  return array.element(index) as unknown as Node<'mat4'>;
}

/** Outputs kept for a view. */
interface ViewOutputs {
  /** Copies of the outputs' textures, by name. */
  readonly behind: Map<string, ExternalTexture>;
  readonly history: PoseHistory;
  destroy(): void;
}

function outputsOfView(view: LayerView): ViewOutputs {
  if (!view.outputs) {
    const behind = new Map<string, ExternalTexture>();
    // Deferred: three may yet submit draws with them.
    const destroy = () => queueMicrotask(() => behind.forEach(destroyCopy));
    const made: ViewOutputs = { behind, history: new PoseHistory(), destroy };
    view.outputs = made;
  }
  return view.outputs as ViewOutputs;
}

/** Returns the names of a pass's outputs apart from its image. */
function otherOutputs(outputs: MRTNode | null): string[] {
  return Object.keys(outputs?.outputNodes ?? {}).filter((name) => name !== 'output');
}

/** Returns `copy` if it fits `texture`; if not, destroys it and returns another. */
function fittingCopy(
  copy: ExternalTexture | undefined,
  { format, width, height }: GPUTexture,
  device: GPUDevice,
): ExternalTexture {
  const old = copy?.sourceTexture as GPUTexture | undefined;
  if (old?.format === format && old.width === width && old.height === height) return copy!;
  if (copy) queueMicrotask(() => destroyCopy(copy));
  const usage = GPUTextureUsage.COPY_DST | GPUTextureUsage.TEXTURE_BINDING;
  const label = 'output behind the splats';
  const made = new ExternalTexture(device.createTexture({ label, size: [width, height], format, usage }));
  // The type decides whether three binds the texture as filterable.
  made.type = format.endsWith('32float') ? FloatType : UnsignedByteType;
  return made;
}

function destroyCopy(copy: ExternalTexture): void {
  (copy.sourceTexture as GPUTexture).destroy();
  copy.dispose();
}

function poseOf(clouds: Iterable<LayerCloud>, camera: Camera): Pose {
  // Temporal effects shift the camera by parts of a pixel, and give three the unshifted projection.
  const projection = velocity.projectionMatrix ?? camera.projectionMatrix;
  return {
    clipMatrix: projection.clone().multiply(camera.matrixWorldInverse),
    clouds: new Map(
      [...clouds].map((cloud) => [
        cloud,
        { modelMatrix: cloud.matrixWorld.clone(), bounds: cloud.geometry.boundingBox! },
      ]),
    ),
  };
}

/**
 * Returns the texture, with one sample per pixel, of the output with this name of the pass that
 * `renderer` is recording, or null if it has none. Call while the pass is interrupted: `openPass`
 * has checked three's internals that are read here.
 */
function outputTexture(renderer: WebGPURenderer, name: string): GPUTexture | null {
  const { backend, _currentRenderContext: context } = renderer as unknown as RendererInternals;
  const texture = context?.textures?.find((each) => each.name === name);
  return (texture && (backend.get(texture) as TextureData).texture) ?? null;
}

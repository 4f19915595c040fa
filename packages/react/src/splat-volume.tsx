import { extend, type ThreeElements } from '@react-three/fiber';
import { volumes } from '@websplatter/core/effects';
import { SplatVolumeObject, type SplatVolumeParameters } from '@websplatter/three';
import type { ReactNode, Ref } from 'react';
import { colorInEngine, type SplatColor } from './effect-props.ts';

/** Props of `<SplatVolume>`: properties of a `SplatVolumeObject`, and props of every object. */
export interface SplatVolumeProps
  extends Omit<ThreeElements['object3D'], 'ref' | 'args'>,
    Omit<SplatVolumeParameters, 'tint'> {
  /** Factor of colours, for `mode="tint"`: a colour, or red, green and blue, sRGB-encoded, 0 or more. */
  tint?: SplatColor;
  /** The object in the scene: set its properties for changes in every frame. */
  ref?: Ref<SplatVolumeObject>;
}

const VolumeElement = /* @__PURE__ */ extend(SplatVolumeObject);

/**
 * A volume in the scene that hides, keeps, fades, tints or displaces the splats in it: `shape` and
 * `mode` say how. Place, turn and scale it as any object, also by controls and springs.
 *
 * It acts on the clouds below its nearest ancestor with clouds: inside of a `<Splats>`, on that one
 * alone. Volumes act in the order of the scene's tree. Numbers out of range are clamped.
 *
 * @throws InvalidArgumentError for an unknown shape or mode, and for values such as NaN.
 * @example
 * <SplatCanvas flat>
 *   <Splats src="/garden.ply" />
 *   <SplatVolume shape="sphere" mode="hide" softEdge={0.1} position={[0, 1, 0]} scale={0.3} />
 * </SplatCanvas>
 */
export function SplatVolume({ tint, ...props }: SplatVolumeProps): ReactNode {
  // A Color is converted: react-three-fiber would copy later colours into it.
  const given = { ...props, ...(tint !== undefined && { tint: colorInEngine(tint) }) };
  const { shape, mode, softEdge, invert, size, radius, height, opacity, offset } = given;
  checkVolume({ shape, mode, softEdge, invert, size, radius, height, opacity, offset, tint: given.tint });
  return <VolumeElement {...given} />;
}

/** Checks props before they are set on an object, where a frame would report them. */
function checkVolume(parameters: SplatVolumeParameters): void {
  const set = Object.entries(parameters).filter(([, value]) => value !== undefined);
  volumes([new SplatVolumeObject(Object.fromEntries(set)).toVolume()]);
}

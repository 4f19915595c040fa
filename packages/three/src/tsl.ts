/**
 * Effects by three's nodes (`@websplatter/three/tsl`), apart from the rest: pages without them do not
 * download the compiler.
 *
 * @module
 */
export {
  type SplatNodes,
  splatColor,
  splatIndex,
  splatNode,
  splatOpacity,
  splatPosition,
  splatPositionWorld,
  splatRotation,
  splatRow,
  splatScale,
  turned,
} from './tsl/splat-node.ts';

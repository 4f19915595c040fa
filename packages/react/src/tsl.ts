/**
 * Effects by three's nodes (`@websplatter/react/tsl`): re-exports @websplatter/three/tsl.
 *
 * @module
 */
export * from '@websplatter/three/tsl';

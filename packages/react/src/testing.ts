/**
 * Tests of components without a GPU (`@websplatter/react/testing`): re-exports
 * @websplatter/three/testing.
 *
 * @module
 */
export * from '@websplatter/three/testing';

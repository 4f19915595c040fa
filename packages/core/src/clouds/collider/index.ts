/**
 * Meshes for physics engines, made from splats in a worker.
 *
 * @module
 */
export { type ColliderMesh, type ColliderMeshOptions, makeColliderMesh } from './make-collider-mesh.ts';

export { type ColliderMesh, type ColliderMeshOptions, makeColliderMesh } from './make-collider-mesh.ts';

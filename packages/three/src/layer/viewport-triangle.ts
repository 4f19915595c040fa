import { Box3, BufferGeometry, Float32BufferAttribute, type Material, Object3D, Sphere } from 'three/webgpu';

/**
 * A triangle over the viewport in the user's scene. three draws it like a Mesh, but applications,
 * editors and exporters that look for meshes pass by: they would export the triangle, or replace its
 * material.
 */
export class ViewportTriangle<Shown extends Material> extends Object3D {
  readonly isSprite = true;
  readonly geometry = viewportTriangle();
  material: Shown;
  /** Instances that three draws: 0 or 1. */
  override count = 1;

  constructor(material: Shown, renderOrder: number) {
    super();
    this.material = material;
    this.renderOrder = renderOrder;
    this.frustumCulled = false;
    this.matrixAutoUpdate = false;
    this.matrixWorldAutoUpdate = false;
    // Each cloud has layers of its own, which are tested for each camera.
    this.layers.enableAll();
  }

  override raycast(): void {}
}

function viewportTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  // The material places the corners. These are in the middle of the clouds, so that a scene's bounds
  // stay, also if they are computed vertex by vertex.
  geometry.setAttribute('position', new Float32BufferAttribute(9, 3));
  return withBounds(geometry, new Box3());
}

export function withBounds(geometry: BufferGeometry, bounds: Box3): BufferGeometry {
  geometry.boundingBox = bounds;
  geometry.boundingSphere = bounds.getBoundingSphere(new Sphere());
  return geometry;
}

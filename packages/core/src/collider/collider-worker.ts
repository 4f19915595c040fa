import { type ColliderPort, serveCollider } from './serve-collider.ts';

serveCollider(self as unknown as ColliderPort);

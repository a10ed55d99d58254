/** A page that loads a .glb with its baked light and says when its first picture was there. */
import { irradia } from "@irradia/three";
import { Scene, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { firstPicture, newCamera } from "./first-picture.js";

const gltf = await new GLTFLoader().register(irradia()).loadAsync("/scene.glb");
const renderer = new WebGLRenderer({ preserveDrawingBuffer: true });
const scene = new Scene().add(gltf.scene);
firstPicture(renderer, () => renderer.render(scene, newCamera()));

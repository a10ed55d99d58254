declare module "gltf-validator" {
  interface Message {
    code: string;
    message: string;
    severity: number;
    pointer?: string;
  }
  interface Report {
    issues: { messages: Message[] };
  }
  const validator: {
    validateBytes(data: Uint8Array, options?: { maxIssues?: number }): Promise<Report>;
  };
  export default validator;
}
